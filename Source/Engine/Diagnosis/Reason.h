// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Compare.h"
#include "Engine/Loudspeaker/Model.h"

#include <map>
#include <string>

namespace excursion {

/// The evidence for this effect and no other, in three short sentences that the user can check on a plot: how much the
/// error of each channel falls, the shape of its law or its linear parameters, and where to look for it. What is the
/// same for all candidates, such as the error before, is left to the caller.
/// @param with  the model with the effect, refitted (or as proposed by the score test)
/// @param errorDbAfter  dB, of the channels whose error with the effect is known
std::string reasonFor(const Effect&, const Model& with, const Comparison& before,
                      const std::map<Quantity, double>& errorDbAfter);

}  // namespace excursion
