// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Compare.h"
#include "Engine/Driver/Model.h"

#include <map>
#include <string>

namespace excursion {

/// Why an effect is held to be missing, in one sentence that a person can check on a plot: how far the errors fall, how
/// the law bends or the linear parameters come out, what betrays the effect, and the parity of the error.
/// @param with  the model with the effect, refitted (or as the score test proposes it)
std::string reasonFor(const Effect&, const Model& with, const Comparison& before,
                      const std::map<Quantity, double>& errorDbAfter);

}  // namespace excursion
