// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/OpenError.h"

#include "Engine/Loudspeaker/FeedbackError.h"
#include "Engine/Loudspeaker/OutputError.h"

#include <Eigen/Eigenvalues>

#include <cmath>

namespace excursion {

std::vector<OpenError> openError(const Model& model, const Record& record, std::size_t section)
{
    std::vector<OpenError> result(record.channels.size());
    const auto active = freeParameters(model);
    if (!hasPeriods(record) || active.empty() || model.covariance.rows() != parameterVector(model).size())
        return result;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> C(Eigen::MatrixXd(model.covariance(active, active)));
    const Eigen::MatrixXd root = C.eigenvectors() * C.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
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
