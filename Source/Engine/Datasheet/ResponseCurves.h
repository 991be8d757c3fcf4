// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Datasheet/KnownScale.h"
#include "Engine/Estimate/Frf.h"
#include "Engine/Progress.h"
#include "Engine/Take/Measurement.h"

#include <vector>

namespace excursion {

// Impedance and sound for programs that design crossovers and boxes. Sound is that of 2.83 V at 1 m, over 20 uPa: the
// level in dB that writeFrd() writes is a sound pressure level.

/// Frequencies evenly spaced on a logarithmic axis, both ends among them, Hz.
std::vector<double> curveFrequencies(double low, double high, double pointsPerOctave = 48.0);

/// Of small signals. @throws Error (data) without a coil
Frf impedanceCurve(const Model&, const std::vector<double>& frequency);

/// Of small signals, in front of the cone: without the time of flight to the microphone.
/// @throws Error (data) without a coil, and where moving mass or area are a guess that the sound depends on
Frf soundCurve(const ScaledModel&, const std::vector<double>& frequency);

/// A take of the model: an odd random-phase multisine, pink, of so many V rms, four realizations of a settled period.
Measurement playedAt(const Model&, double level, double low, double high, const Progress& = {});

/// Best linear approximations of a take at the level that lies within a tenth of so many V rms, at the loudest of all
/// without. The sound is referred to 1 m by the distance that the take tells, and has the time of flight in its phase.
/// @throws Error (data) where there is no such level, saying which there are, or no such channel
Frf impedanceCurve(const Measurement&, double level = 0.0);
Frf soundCurve(const Measurement&, double level = 0.0);

}  // namespace excursion
