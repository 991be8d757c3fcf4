// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Estimate/Record.h"

#include <Eigen/Core>

#include <vector>

namespace excursion {

/// State z of Dynamics at an instant, and its derivative by the parameters of the model.
struct StartState {
    Eigen::VectorXd value;
    Eigen::MatrixXd gradient;  ///< states x parameters in the order of parametersOf(); empty unless asked for
};

/// At the start of a periodic section's drive, the linear part of the model is already in its steady state,
///     z(t) = 1/N sum_k (j w_k I - A)^-1 B U_k exp(j w_k t)   over the lines of the input, both signs of w
/// (SmallSignal). The lead-in then only has to settle the nonlinear part. Otherwise, relaxations far slower than any
/// lead-in, such as those of a creeping suspension, would drift through the window and look like a model error.
/// Memories of laws start where that motion brings them within a period, slow ones where the preceding part of the take
/// brings them by the time of the window (LawMemory.h), as they are to stand still until then (Window::slowStands). A
/// section without periods starts at rest (an empty state), except for slow memories.
/// @param leadIn  as passed to Record::drive
std::vector<StartState> startStates(const Model&, const Record&, const std::vector<std::size_t>& sections,
                                    std::size_t leadIn, bool withGradient, unsigned threads);

}  // namespace excursion
