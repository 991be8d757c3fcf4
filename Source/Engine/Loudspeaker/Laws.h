// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <string>
#include <vector>

namespace excursion {

/// A law of the model with its 95 % band over the visited range [-range, range], for plots and reports. Where something
/// relaxes beside it, a law is what the take shows at one frequency, as what it comes to far beyond the band is an
/// extrapolation: beside creep K(x) is Re F/x at the lowest measured frequency and Rms(v) is Im F/(w x) at resonance,
/// beside eddy currents Le is Im u/(w i) of the blocked coil an octave below the highest.
/// What a bent spring yields beside creep is left out.
struct LawCurve {
    LawInfo info;
    std::string effectId;                            ///< id of the effect with this law
    double frequency = 0.0;                          ///< Hz, of such a law; 0 for one that holds at any
    std::vector<double> argument, value, halfWidth;  ///< halfWidth of the 95 % band; NaN if unknown
};

/// "Le(x)", or "Le(x) at 2.4 kHz" where it is told at a frequency in Hz above 0.
std::string titleOfLaw(const std::string& name, double frequency);

/// The laws of a model in the order of its components, at so many arguments each.
std::vector<LawCurve> laws(const Model&, int points = 81);

}  // namespace excursion
