// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Compare.h"
#include "Engine/Loudspeaker/Model.h"

#include <map>
#include <string>

namespace excursion {

/// What speaks for an effect and for no other, in three short sentences that a person can check on a plot: by how much
/// the error of each channel falls, what shape its law has or what its linear parameters come out as, and where to look
/// for it. What is the same for all that compete, such as the error before, is left to those who show them.
/// @param with  the model with the effect, refitted (or as the score test proposes it)
/// @param errorDbAfter  dB, of the channels that are known with the effect
std::string reasonFor(const Effect&, const Model& with, const Comparison& before,
                      const std::map<Quantity, double>& errorDbAfter);

}  // namespace excursion
