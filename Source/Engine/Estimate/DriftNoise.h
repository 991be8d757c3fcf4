// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/AveragedPeriods.h"

#include <vector>

namespace excursion {

/// The noise of the played lines beside what drifts from period to period. A parameter that drifts, as the resistance
/// of a coil that warms, changes a response by something smooth in frequency; noise is another one on every line. So
/// over neighbouring played lines k, by a local linear model (Pintelon & Schoukens 2012, 7.2)
///     Y_kp - Ybar_k = (a_p + b_p kappa + c_p kappa^2) Ubar_k + noise_kp,   kappa ~ k,
/// with complex a, b, c of each period p, and what is left is the noise, with the little by which distortion drifts.
/// Ybar_k is no good to follow that by: a line that sticks out of it would be told exactly. Works where every line is
/// played; silent lines, where there are some, assume less (withoutDrift()).
/// @return of each line, the variance of Ybar_k, in the channel's unit squared, pooled over the realizations and shared
///         by neighbours; a line that sticks out (hum) keeps a sixth of its own. Infinite where nothing was played or
///         too few lines are there to tell. Empty if noise is unknown
std::vector<double> noiseBesideDrift(const AveragedPeriods&, const Channel&, int level);

}  // namespace excursion
