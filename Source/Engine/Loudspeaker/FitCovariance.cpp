// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/FitCovariance.h"

#include "Engine/Numerics/NormalEquations.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {
namespace {

/// P of ShapesLeft.
Eigen::VectorXd variancesOf(const Model& model, const ShapesLeft& left, double scatter)
{
    const auto all = parametersOf(model);
    Eigen::VectorXd P(static_cast<Eigen::Index>(left.parameters.size()));
    for (Eigen::Index k = 0; k < P.size(); ++k) {
        const auto* p = all[static_cast<std::size_t>(left.parameters[static_cast<std::size_t>(k)])];
        P[k] = 1.0 / (std::pow(p->prior, -2) + left.own[k] / scatter);
    }
    return P;
}

}  // namespace

void keepCovariance(Model& model, const FitCurvature& fit, const ShapesLeft& left)
{
    const auto size = parameterVector(model).size();
    const auto inverse = covarianceOf(fit.N, 1.0);
    const Eigen::MatrixXd known = inverse.unaryExpr([](double c) { return std::isfinite(c) ? c : 0.0; });
    const Eigen::MatrixXd M = fit.shared.size() > 0 ? fit.JtJ + fit.shared : fit.JtJ;
    const double dispersion = std::max(fit.scatter, overdispersionOf(fit.N, M, fit.pulls));
    const auto& active = fit.parameters;
    Eigen::MatrixXd own = known * (dispersion * M + fit.scatter * (fit.N - fit.JtJ)) * known;
    own = (0.5 * (own + own.transpose())).eval();
    model.inverseCurvature = model.covariance = Eigen::MatrixXd::Zero(size, size);
    model.inverseCurvature(active, active) = fit.scatter * inverse;
    if (!left.parameters.empty()) {
        const auto P = variancesOf(model, left, fit.scatter);
        const Eigen::MatrixXd T = known * left.beside, TP = T * P.asDiagonal();
        own += TP * T.transpose();
        model.covariance(active, left.parameters) = -TP;
        model.covariance(left.parameters, active) = -TP.transpose();
        model.covariance(left.parameters, left.parameters) = Eigen::MatrixXd(P.asDiagonal());
    }
    for (Eigen::Index k = 0; k < own.rows(); ++k)
        if (!std::isfinite(inverse(k, k)))
            own(k, k) = std::numeric_limits<double>::quiet_NaN();
    model.covariance(active, active) = own;
}

}  // namespace excursion
