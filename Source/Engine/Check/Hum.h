// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/AveragedPeriods.h"

#include <optional>

namespace excursion {

/// Mains hum in a channel: lines at 50 or 60 Hz and harmonics that stand far above the noise beside them, in what is
/// left when the averaged period is taken away. Hum that is synchronous with the period cannot be seen so.
struct Hum {
    double mains = 50.0;      ///< Hz
    double db = 0.0;          ///< power of the hum over the power of the channel's signal at the loudest level
    double aboveNoise = 0.0;  ///< dB, power of the hum over all other noise in the channel
    int harmonics = 0;        ///< how many stand out, of the first six
};

/// Empty when fewer than two harmonics stand 15 dB above their surroundings and none 25 dB, or
/// there is a single period.
std::optional<Hum> findHum(const AveragedPeriods&, const Channel&);

}  // namespace excursion
