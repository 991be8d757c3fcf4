// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Hammerstein/ParallelHammerstein.h"

#include "Engine/Error.h"
#include "Engine/Signal/Convolution.h"
#include "Engine/Validity.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <span>

namespace excursion {

using Eigen::Index;

bool ParallelHammerstein::isValid(std::string* reason) const
{
    if (!(std::isfinite(sampleRate) && sampleRate > 0.0))
        return refuse(reason, "a parallel Hammerstein model needs a sample rate above 0 Hz");
    if (filters.size() == 0)
        return refuse(reason, "a parallel Hammerstein model needs at least one branch and one tap");
    if (!filters.allFinite() || !std::isfinite(offset))
        return refuse(reason, "a coefficient of a branch is not finite");
    return true;
}

Eigen::MatrixXd simulate(const ParallelHammerstein& model, const Eigen::MatrixXd& input)
{
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be simulated: " + reason + ".");
    if (input.cols() != 1)
        throw Error(Error::Kind::usage,
                    "A parallel Hammerstein model has one input, but the record has another number.");
    Eigen::VectorXd power = Eigen::VectorXd::Ones(input.rows()),
                    y = Eigen::VectorXd::Constant(input.rows(), model.offset);
    for (Index n = 0; n < model.degree(); ++n) {
        power.array() *= input.col(0).array();
        const Eigen::VectorXd taps = model.filters.col(n);
        const auto branch = convolved(std::span(taps.data(), static_cast<std::size_t>(taps.size())),
                                      std::span(power.data(), static_cast<std::size_t>(power.size())));
        y += Eigen::Map<const Eigen::VectorXd>(branch.data(), y.size());
    }
    return y;
}

Eigen::MatrixXcd responses(const ParallelHammerstein& model, const std::vector<double>& frequency)
{
    Eigen::MatrixXcd result(static_cast<Index>(frequency.size()), model.degree());
    for (Index f = 0; f < result.rows(); ++f) {
        const auto step = std::polar(1.0, -2.0 * std::numbers::pi * frequency[static_cast<std::size_t>(f)]
                                              / model.sampleRate);
        Eigen::RowVectorXcd sum = Eigen::RowVectorXcd::Zero(model.degree());
        for (Index k = model.length(); k-- > 0;)  // Horner
            sum = (sum * step + model.filters.row(k)).eval();
        result.row(f) = sum;
    }
    return result;
}

}  // namespace excursion
