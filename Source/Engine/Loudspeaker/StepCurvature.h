// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/Record.h"
#include "Engine/Loudspeaker/OutputError.h"

#include <Eigen/Core>

#include <cstddef>
#include <functional>
#include <vector>

namespace excursion {

/// How the residuals of a fit bend along a step of its search, as the parameters see it,
///     J^T r'',   r'' = (r(theta + h d) - 2 r(theta) + r(theta - h d)) / h^2,
/// with J of the place that the step begins at. Where J is that of fed laws r'' is, too, as they cost less than a
/// simulation.
class StepCurvature {
public:
    /// Sections as they are predicted at theta, with spectra.
    using Predict = std::function<std::vector<SectionFit>(const Eigen::VectorXd& theta)>;

    /// @param sections  indices into record.sections; they and the record outlive this
    StepCurvature(const Record&, const std::vector<std::size_t>& sections, Predict);

    /// @param fits  of the place that the next steps begin at, with slopes
    void beginAt(std::vector<SectionFit> fits);

    /// @param step  of the parameters that the slopes are by; one that theta - h d would take out of its bounds counts
    ///              as if it stayed
    /// @returns empty where a prediction is not finite
    Eigen::VectorXd along(const Eigen::VectorXd& theta, const Eigen::VectorXd& step, const Eigen::VectorXd& lower,
                          const Eigen::VectorXd& upper);

private:
    const Record& record_;
    const std::vector<std::size_t>& sections_;
    Predict predict_;
    std::vector<SectionFit> slopes_, here_;  ///< here_: predicted where the steps begin, once it was asked for
};

}  // namespace excursion
