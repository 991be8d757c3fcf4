// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Datasheet/KnownScale.h"
#include "Engine/Loudspeaker/Laws.h"

#include <string>
#include <vector>

namespace excursion {

/// A large-signal law over what the take visited, with the ends of its 95 % band (NaN: unknown).
struct LawTable {
    std::string name;                          ///< "Bl(x)", "K(x)", "Cms(x)", "Le(x)", "Le(i)", "Rms(v)"
    std::string unit, argument, argumentUnit;  ///< SI
    std::vector<double> at, value, low95, high95;
    double frequency = 0.0;  ///< Hz, of a law that is told at one (LawCurve); else 0
};

LawTable tableOf(const LawCurve&);

/// The laws of the model's effects, and with K(x) its reciprocal Cms(x). Where the motion is a guess there are only
/// those against the current.
/// @param points  at least 3; an odd number has one at rest
std::vector<LawTable> lawTables(const ScaledModel&, int points = 41);

}  // namespace excursion
