// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <string>
#include <vector>

namespace excursion {

/// A law of the model with its 95 % band over the visited range [-range, range], for plots and reports. Beside a
/// suspension that creeps K(x) is the stiffness at the lowest measured frequency: what it comes to rest at is an
/// extrapolation. Le(x) is the coil's own inductance, which beside eddy currents is one, too.
struct LawCurve {
    LawInfo info;
    std::string effectId;                            ///< id of the effect with this law
    double frequency = 0.0;                          ///< Hz, of such a law; 0 for one that holds at any
    std::vector<double> argument, value, halfWidth;  ///< halfWidth of the 95 % band; NaN if unknown
};

/// The laws of a model in the order of its components, at so many arguments each.
std::vector<LawCurve> laws(const Model&, int points = 81);

}  // namespace excursion
