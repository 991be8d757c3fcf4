// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/OpenError.h"
#include "Engine/Loudspeaker/Residual.h"

#include <optional>

namespace excursion {

/// The error of a model in one channel: relative rms error [B 4.26], and the rms of the noise relative to the same
/// reference, dB. `chiSquaredPerValue` is the mean of |error|^2/sigma^2 over the lines: 1 if only noise is left.
struct ErrorLevel {
    double db = 0.0;
    std::optional<double> noiseFloorDb;  ///< empty if the take does not show its noise
    double chiSquaredPerValue = 0.0;
    /// What one standard error of the parameters leaves beside the noise, in units of the noise: of chiSquaredPerValue,
    /// and of the power. Asked for once an error of the comparison stands over the noise and none is above four times
    /// it; else 0. Not in documents.
    double openChiSquared = 0.0, openPower = 0.0;
};

/// Whether an error is nothing but noise: line by line, and in power, as a few lines with much of it hardly count among
/// thousands. What three standard errors of the parameters leave is no sign of anything unknown: the temperature of a
/// coil in a section that was played after all that were fitted can be as open as that.
bool isNoise(const ErrorLevel&);

/// What an error level is made of, summed over sections.
struct ErrorSums {
    ErrorPower power;
    double cost = 0.0, rows = 0.0;  ///< of the residuals
    OpenError open;
};

ErrorLevel levelOf(const ErrorSums&, bool noiseKnown);

/// One power over another in dB.
double powerRatioDb(double power, double reference);

}  // namespace excursion
