// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/Measurement.h"

#include <complex>
#include <optional>
#include <vector>

namespace excursion {

/// Nonlinear distortion on the lines that the multisine leaves out: the fast method (Pintelon, D'haene & Schoukens;
/// Pintelon & Schoukens 2012, 4.3.1). Only odd lines are excited, so an even nonlinearity falls on even lines, an odd
/// one on odd lines, and the odd lines left out (detection lines) show how strong it is among the excited ones.
///
/// Where the amplifier distorts, the input has power on these lines too, which the driver passes on
/// linearly. That part is taken out with the best linear approximation, interpolated between excited lines:
///     Yc(k) = Ybar(k) - G(k) Ubar(k),      power(k) = 1/M sum_m |Yc_m(k)|^2
/// with noise(k) the expectation that noise alone gives power(k), from the scatter of Y - G U over the periods.
struct DetectionLines {
    std::vector<int> lines;         ///< DFT lines between the first and the last excited one
    std::vector<double> frequency;  ///< Hz
    std::vector<double> power;      ///< |Yc|^2 of the averaged period, unnormalized DFT (Fft.h)
    std::vector<double> noise;      ///< the share of `power` that is noise; empty when P = 1
};

/// A total over the excited band, relative to the output's power on the excited lines.
struct DistortionTotal {
    double db = 0.0;           ///< 10 log10, noise subtracted; an upper limit when not significant
    bool significant = false;  ///< stands above what noise alone explains by more than 4 standard deviations
};

struct DistortionResult {
    Quantity output = Quantity::current;
    int level = 0;
    std::vector<int> excited;          ///< the excited lines
    std::vector<double> excitedPower;  ///< 1/M sum_m |Ybar_m|^2 on them
    DetectionLines odd, even;          ///< empty when the grid leaves none out

    /// Odd distortion is summed over every odd line of the band, also the excited ones, whose share is interpolated
    /// between detection lines. Absent when there are no detection lines of that kind.
    std::optional<DistortionTotal> oddTotal, evenTotal;

    /// Noise of the averaged period over all lines of the band, relative to the excited power; absent when P = 1.
    std::optional<double> noiseDb;
};

/// @throws Error (data) when the channel, the periods or the lines are missing, or an even line is
/// excited: then even and odd nonlinearities fall on the same lines and cannot be told apart
DistortionResult distortion(const Measurement&, Quantity output, int level);

}  // namespace excursion
