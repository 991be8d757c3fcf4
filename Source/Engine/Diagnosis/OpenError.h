// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/Record.h"
#include "Engine/Loudspeaker/Model.h"

#include <cstddef>
#include <vector>

namespace excursion {

/// What the parameters of a model leave open in one channel of a section, summed over its lines: the variance of what
/// the model predicts, diag(J C J^T), with the slopes J of the predicted lines by the parameters and the covariance C
/// of these. A parameter of which the fit told nothing counts as known: its prior holds it.
struct OpenError {
    double chiSquared = 0.0;  ///< in units of each line's noise
    double power = 0.0;       ///< as ErrorPower's

    void add(const OpenError& other)
    {
        chiSquared += other.chiSquared;
        power += other.power;
    }
};

/// By channel. All zero for a model without covariance, and for a section that is not periodic.
std::vector<OpenError> openError(const Model&, const Record&, std::size_t section);

}  // namespace excursion
