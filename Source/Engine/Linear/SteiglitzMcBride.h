// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/StateSpace.h"

#include <span>

namespace excursion {

/// A linear model of one record in the time domain, without any frequency response, by iterative prefiltering
/// (Steiglitz and McBride 1965, "A technique for the identification of linear systems"): with A of the last iteration,
/// first 1,
///     A(q) y_f = B(q) u_f + c(q) delta_f,   x_f = x / A_last(q),
/// is linear least squares in A, B and c, and where A stays the same its error is that of a simulation. c is what the
/// states at the beginning add. It asks nothing of the input but that it moves the system: a sweep, where a response
/// from one record has no second look at any line, will do. Poles outside of the unit circle are mirrored into it after
/// every iteration.
/// @return  balanced (see Reduction.h), of discrete time
/// Throws Error (data) where the record is shorter than four times its unknowns or no such model explains it.
StateSpace steiglitzMcBride(std::span<const double> input, std::span<const double> output, double sampleRate, int order,
                            int iterations = 12);

}  // namespace excursion
