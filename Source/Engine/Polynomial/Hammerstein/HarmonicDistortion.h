// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/Hammerstein/HammersteinSweep.h"
#include "Engine/Progress.h"
#include "Engine/Take/SweepTake.h"

#include <string>
#include <vector>

namespace excursion {

struct HarmonicOptions {
    int highest = 5;                ///< N: harmonics 2 .. N are told apart
    double pointsPerOctave = 12.0;  ///< of the curves

    bool isValid(std::string* reason = nullptr) const;
};

/// The harmonics of one channel at one level over the frequency f of the fundamental. A number is NaN where it is not
/// known: a harmonic where it or its fundamental lies outside of what was played and sampled, or does not rise above
/// its floor; a floor outside of the band, or where the silence is too short to tell the noise.
struct HarmonicCurves {
    Quantity quantity = Quantity::voltage;
    std::string unit;
    double level = 0.0;               ///< V rms of the sweep
    std::vector<double> frequency;    ///< Hz
    std::vector<double> fundamental;  ///< rms, in the unit
    Eigen::MatrixXd db;               ///< points x (N-1), column m-2: |H_m(m f)| over |H_1(f)|
    Eigen::MatrixXd floorDb;          ///< what noise, and what the drive has of the harmonic itself, may look like
    std::vector<double> thdDb;        ///< root of the sum of squares of what is above its floor
    std::vector<double> thdFloorDb;   ///< of the floors of all harmonics within the band
};

struct HarmonicDistortion {
    int highest = 0;
    double response = 0.0;                 ///< s of a response that were kept, the edges of the window included
    double bandLow = 0.0, bandHigh = 0.0;  ///< Hz, of the fundamental
    std::vector<HarmonicCurves> curves;    ///< channel by channel, quiet to loud
    std::vector<std::string> remarks;      ///< sentences for a person
};

/// The higher harmonic responses H_m of all channels at all levels (see HarmonicResponses; Novak, Lotton & Simon 2015),
/// of the mean over the repeats of a sweep. What the drive has of harmonic m itself passes the linear part and is taken
/// off,
///     H_m(F) - H_1(F) U_m(F)/U_1(F)      at the frequency F = m f of the harmonic, where the sweep plays F,
/// with U the harmonic responses of the voltage (or force) that was recorded: distortion of the amplifier, and what the
/// ends of the sweep leave of the method itself. Powers are means over a pointsPerOctave-th of an octave, less the
/// noise; that of the fundamental is divided by what is found in the sweep itself, as the window smears its beginning.
///
/// The noise of a line comes from the silence behind the sweeps, once a response has died away: the mean power there
/// under the window of a response, over |fs X(F)|^2, and for a sweep that is repeated from the scatter of the repeats
/// where that is more. The floor is 4.6 times it, which noise alone exceeds on one line of a hundred, and a hundredth
/// of what was taken off.
///
/// Throws Error (usage) for options, (data) for a take that does not tell its sweeps, or whose sweeps are too short to
/// keep the harmonics apart.
HarmonicDistortion harmonicDistortion(const SweepTake&, const HarmonicOptions& = {}, const Progress& = {});

}  // namespace excursion
