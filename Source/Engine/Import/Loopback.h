// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/PlanPeriods.h"
#include "Engine/Import/ResponseCurve.h"

#include <optional>
#include <span>

namespace excursion {

/// What an interface does to a signal between its output and its inputs, but for gain and delay.
struct InterfaceResponse {
    bool flat = true;                    ///< it departs from a gain by no more than its uncertainty
    double mostDb = 0.0;                 ///< largest departure of the level within the plan's band
    double mostDegrees = 0.0;            ///< and of the phase
    double errorDb = 0.0;                ///< standard error of a point
    std::optional<ResponseCurve> curve;  ///< where it is not flat: over its mean gain
};

/// @param loopback  the interface's output, recorded by one of its inputs, on the plan's clock
/// @param used      indices of PlanPeriods::periods
///
/// H(k) of PeriodDelays over its mean gain, each point the mean of the lines within a twelfth of an octave of it. It is
/// not flat when the mean square of H - 1 exceeds four times that of its standard error, and 1e-8.
InterfaceResponse interfaceResponse(const PlanPeriods&, std::span<const double> loopback,
                                    const std::vector<std::size_t>& used, double sampleRate);

}  // namespace excursion
