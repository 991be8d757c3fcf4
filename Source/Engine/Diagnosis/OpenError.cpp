// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/OpenError.h"

#include "Engine/Loudspeaker/FeedbackError.h"
#include "Engine/Loudspeaker/OutputError.h"
#include "Engine/Numerics/Eigenvalues.h"

#include <cmath>

namespace excursion {
namespace {

/// A root of the covariance, C = root root^T. In units of the standard errors, as variances differ by twenty orders of
/// magnitude.
Eigen::MatrixXd rootOf(const Eigen::MatrixXd& C)
{
    const Eigen::VectorXd deviation = C.diagonal().cwiseSqrt();
    const auto [values, vectors] = symmetricEigenvectors(deviation.cwiseInverse().asDiagonal() * C
                                                         * deviation.cwiseInverse().asDiagonal());
    return deviation.asDiagonal() * vectors * values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

}  // namespace

std::vector<OpenError> openError(const Model& model, const Record& record, std::size_t section)
{
    std::vector<OpenError> result(record.channels.size());
    if (!hasPeriods(record) || model.covariance.rows() != parameterVector(model).size())
        return result;
    auto active = freeParameters(model);
    std::erase_if(active, [&](Eigen::Index k) {
        return !(model.covariance(k, k) > 0.0 && std::isfinite(model.covariance(k, k)));
    });
    if (active.empty())
        return result;
    const Eigen::MatrixXd root = rootOf(model.covariance(active, active));
    OutputErrorOptions run;
    run.slopes = true;
    const auto fit = std::move(quickError(model, record, {section}, active, run).front());
    if (!fit.finite)
        return result;
    const auto& deviation = record.sections[section].deviation;
    const auto first = record.lineRange(record.sections[section]).first;
    for (std::size_t c = 0; c < result.size(); ++c) {
        const Eigen::VectorXd variance = (fit.slopes[c].cast<double>() * root).rowwise().squaredNorm();
        const auto lines = variance.size() / 2;  // real parts, then imaginary ones
        result[c].chiSquared = variance.sum();
        for (Eigen::Index n = 0; n < lines; ++n)
            result[c].power += 0.5 * (variance[n] + variance[n + lines])
                               * std::pow(deviation[c][first + static_cast<std::size_t>(n)], 2);
    }
    return result;
}

}  // namespace excursion
