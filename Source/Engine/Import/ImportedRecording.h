// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/AlignRecording.h"
#include "Engine/Import/Loopback.h"
#include "Engine/Take/Measurement.h"
#include "Engine/Take/SweepExcitation.h"

#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// What became of one file.
struct ImportedFile {
    std::string name;
    double sampleRate = 0.0, seconds = 0.0;
    Alignment alignment;  ///< not without a plan
    std::string witness;  ///< the channel that told the time
    std::optional<InterfaceResponse> loopback;
};

struct ImportedRecording {
    Measurement take;
    std::optional<SweepExcitation> sweep {};  ///< of a plan of sweeps: those that were recorded, at their levels
    std::vector<ImportedFile> files;
    std::vector<std::string> remarks;  ///< sentences for a person: what was assumed, left out or is odd
};

}  // namespace excursion
