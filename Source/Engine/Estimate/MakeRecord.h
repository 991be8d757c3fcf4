// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/AveragedPeriods.h"
#include "Engine/Estimate/Record.h"

#include <string>
#include <vector>

namespace excursion {

struct RecordOptions {
    /// Keep one realization, or a third of the windows of a take without periods, for validation (HoldOut.h).
    bool holdOut = true;
    double windowSeconds = 0.5;   ///< for aperiodic sections, at least 2048 samples of the take
    double leadInSeconds = 0.25;  ///< before an aperiodic window, at least 1024 samples of the take
    /// The smallest error assumed for the weight of a line, relative to the channel's rms: sensors and integration are
    /// not more accurate. -105 dB.
    double relativeFloor = 5.6e-6;
    std::vector<Quantity> setAside;  ///< channels that nothing is compared with
    /// Hz: the pressure went through a high-pass jf/(jf + corner), which is taken off; 0: none
    double microphoneCorner = 0.0;

    bool isValid(std::string* reason) const;
};

/// Cuts a take into the sections that models are fitted to and compared with. Lines that its excitation does not name
/// are not looked for (completeExcitation() finds them). Of periods without
/// a settling one the first is taken for it. A take without periods is cut into windows, at a lower rate
/// where the band that it drives (DrivenBand.h) leaves room.
/// Throws Error (data) if the take has no output channel or is too short, or states a period in which nothing repeats.
Record makeRecord(const AveragedPeriods&, const RecordOptions& = {});
Record makeRecord(const Measurement&, const RecordOptions& = {});

}  // namespace excursion
