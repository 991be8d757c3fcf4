// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/AveragedPeriods.h"
#include "Engine/Estimate/Record.h"

#include <string>
#include <vector>

namespace excursion {

struct RecordOptions {
    /// Keep one realization (or the last third of an aperiodic take) for validation: the one with the smallest
    /// excursion, as no model is valid where it was never measured.
    bool holdOut = true;
    double windowSeconds = 0.5;   ///< for aperiodic sections, at least 2048 samples
    double leadInSeconds = 0.25;  ///< before an aperiodic window, at least 1024 samples
    /// The smallest error assumed for the weight of a line, relative to the channel's rms: sensors and integration are
    /// not more accurate. -105 dB.
    double relativeFloor = 5.6e-6;
    std::vector<Quantity> setAside;  ///< channels that nothing is compared with
    /// Hz: the pressure went through a high-pass jf/(jf + corner), which is taken off; 0: none
    double microphoneCorner = 0.0;

    bool isValid(std::string* reason) const;
};

/// Cuts a take into the sections that models are fitted to and compared with. Lines that its excitation does not name
/// are not looked for (completeExcitation() finds them).
/// Throws Error (data) if the take has no output channel or is too short, or states a period in which nothing repeats.
Record makeRecord(const AveragedPeriods&, const RecordOptions& = {});
Record makeRecord(const Measurement&, const RecordOptions& = {});

}  // namespace excursion
