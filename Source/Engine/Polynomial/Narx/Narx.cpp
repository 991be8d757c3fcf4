// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Narx/Narx.h"

#include "Engine/Validity.h"

#include <cmath>
#include <vector>

namespace excursion {

using Eigen::Index;

bool Narx::isValid(std::string* reason) const
{
    if (!(std::isfinite(sampleRate) && sampleRate > 0.0))
        return refuse(reason, "a NARX model needs a sample rate above 0 Hz");
    if (outputLags < 0 || inputLags < 0)
        return refuse(reason, "the lags of a NARX model must be at least 0");
    if (exponents.cols() != outputLags + inputLags + 1 || exponents.rows() != coefficients.size())
        return refuse(reason,
                      "a NARX model needs one coefficient a term, and one exponent a lag and for the input itself");
    if (exponents.size() > 0 && exponents.minCoeff() < 0)
        return refuse(reason, "the exponents of a NARX model must be at least 0");
    if (!coefficients.allFinite())
        return refuse(reason, "a coefficient of a NARX model is not finite");
    return true;
}

Pnlss pnlssOf(const Narx& model)
{
    const Index na = model.outputLags, nb = model.inputLags, n = na + nb;
    std::vector<Index> others;
    Pnlss result;
    auto& linear = result.linear;
    linear.sampleRate = model.sampleRate;
    linear.A = Eigen::MatrixXd::Zero(n, n);
    linear.B = Eigen::MatrixXd::Zero(n, 1);
    linear.C = Eigen::MatrixXd::Zero(1, n);
    linear.D = Eigen::MatrixXd::Zero(1, 1);
    for (Index i = 1; i < n; ++i)
        if (i != na)
            linear.A(i, i - 1) = 1.0;
    if (nb > 0)
        linear.B(na, 0) = 1.0;
    for (Index k = 0; k < model.exponents.rows(); ++k) {
        if (model.exponents.row(k).sum() != 1) {
            others.push_back(k);
            continue;
        }
        for (Index v = 0; v < n; ++v)
            linear.C(0, v) += model.exponents(k, v) * model.coefficients[k];
        linear.D(0, 0) += model.exponents(k, n) * model.coefficients[k];
    }
    const auto K = static_cast<Index>(others.size());
    result.exponents = model.exponents(others, Eigen::all);
    result.F = model.coefficients(others).transpose();
    result.E = Eigen::MatrixXd::Zero(n, K);
    result.free = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>::Constant(n + 1, K, false);
    result.free.bottomRows(1).setConstant(true);
    if (na > 0) {
        linear.A.row(0) = linear.C;
        linear.B(0, 0) = linear.D(0, 0);
        result.E.row(0) = result.F;
        result.free.row(0).setConstant(true);
    }
    return result;
}

bool isStable(const Narx& model) { return isStable(pnlssOf(model).linear); }

}  // namespace excursion
