// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/Pnlss/PnlssFit.h"

#include <vector>

namespace excursion {

/// A linear model of a record, with the state at its first sample.
struct LinearStart {
    StateSpace model;
    Eigen::VectorXd initial;
    double errorDb = 0.0;  ///< relative rms error of its simulation [B 4.26]
};

/// Linear models of one aperiodic record, each of which a fit may start from, the most promising first.
///
/// Identified (see Identify.h) from the record's frequency response by the local rational method, which takes
/// transients out, and from the record itself by iterative prefiltering (see SteiglitzMcBride.h). Each is then refined
/// on the record itself, with the state at its beginning, to the least error of a simulation, which has the last word:
/// a response of a nonlinear system wanders from line to line, and a bias there bends the poles. Refined ones come
/// first by ascending error, then the unrefined: each begins a search of the nonlinear model at another place. Those
/// that are refined to the same error are the same, and stand once. Throws Error (data) where neither finds a model,
/// and as requireFitting() does.
std::vector<LinearStart> linearStarts(const InputOutputRecord&, double sampleRate, int order);

/// From rest to the state with which a model explains a record best, the model kept; zero where the model runs away.
Eigen::VectorXd initialStateOf(const Pnlss&, const InputOutputRecord&);

}  // namespace excursion
