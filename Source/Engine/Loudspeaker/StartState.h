// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Loudspeaker/Record.h"

#include <Eigen/Core>

#include <vector>

namespace excursion {

/// State z of Dynamics at an instant, and its derivative by the parameters of the model.
struct StartState {
    Eigen::VectorXd value;
    Eigen::MatrixXd gradient;  ///< states x parameters in the order of parametersOf(); empty unless asked for
};

/// Where a periodic section's drive begins, the linear part of the model already stands in its steady state,
///     z(t) = 1/N sum_k (j w_k I - A)^-1 B U_k exp(j w_k t)   over the lines of the input, both signs of w
/// (SmallSignal). The lead-in then only has to settle what is nonlinear. Relaxations far slower than any lead-in, such
/// as those of a creeping suspension, would otherwise drift through the window and be taken for an error of the model.
/// Memories of laws stand where that motion has brought them within a period, slow ones where the take before has
/// (LawMemory.h). A section without periods starts at rest (an empty state), but for slow memories.
/// @param leadIn  as handed to Record::drive
std::vector<StartState> startStates(const Model&, const Record&, const std::vector<std::size_t>& sections,
                                    std::size_t leadIn, bool withGradient);

}  // namespace excursion
