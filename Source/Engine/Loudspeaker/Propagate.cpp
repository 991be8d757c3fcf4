// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Propagate.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {
namespace {

/// A thousandth of the least of deviation, prior and value. A value that is a rounding of zero does not count: the step
/// is at least a tenth of what the other two make it.
double stepOf(const Parameter& p, double deviation)
{
    constexpr double small = 1e-3, least = 0.1;
    const double spread = std::min(deviation, p.prior);
    if (!std::isfinite(spread))
        return small * (p.value != 0.0 ? std::abs(p.value) : 1.0);
    return small * std::clamp(std::abs(p.value), least * spread, spread);
}

}  // namespace

Eigen::VectorXd standardErrorsOf(const Model& model, const std::function<Eigen::VectorXd(const Model&)>& numbers)
{
    const auto all = parametersOf(model);
    const auto theta = parameterVector(model);
    Eigen::VectorXd errors = Eigen::VectorXd::Constant(numbers(model).size(), std::numeric_limits<double>::quiet_NaN());
    if (model.covariance.rows() != theta.size())
        return errors;
    Model moved = model;
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(errors.size(), theta.size()),
                    covariance = widenedCovariance(model);
    std::vector<Eigen::Index> unseen;
    for (Eigen::Index k = 0; k < theta.size(); ++k) {
        const auto& p = *all[static_cast<std::size_t>(k)];
        const double deviation = std::sqrt(covariance(k, k));
        if (deviation == 0.0)  // held, or of no importance
            continue;
        const bool known = std::isfinite(deviation);
        const double step = stepOf(p, known ? deviation : std::numeric_limits<double>::infinity());
        auto at = theta;
        const auto numbersAt = [&](double value) {
            at[k] = p.value < p.lower || p.value > p.upper ? value : std::clamp(value, p.lower, p.upper);
            setParameterVector(moved, at);
            return std::pair {numbers(moved), at[k]};
        };
        const auto [above, high] = numbersAt(theta[k] + step);
        const auto [below, low] = numbersAt(theta[k] - step);
        if (high > low)
            jacobian.col(k) = (above - below) / (high - low);
        if (!known)
            unseen.push_back(k);
    }
    for (const auto k : unseen) {
        covariance.row(k).setZero();
        covariance.col(k).setZero();
    }
    errors = (jacobian * covariance * jacobian.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt();
    for (const auto k : unseen)
        for (Eigen::Index n = 0; n < errors.size(); ++n)
            if (jacobian(n, k) != 0.0)
                errors[n] = std::numeric_limits<double>::quiet_NaN();
    return errors;
}

}  // namespace excursion
