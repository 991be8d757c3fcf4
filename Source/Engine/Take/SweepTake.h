// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/SweepExcitation.h"

#include <filesystem>
#include <optional>

namespace excursion {

/// A take, and the sweeps that it was played with where it says so. All verbs that know nothing of sweeps see an
/// aperiodic take in it.
struct SweepTake {
    Measurement take;
    std::optional<SweepExcitation> sweep;
};

/// As writeMeasurement and writePlan, with the sweeps in measurement.json and plan.json.
void writeSweepTake(const SweepTake&, const std::filesystem::path& folder);
void writeSweepPlan(const SweepTake&, const std::filesystem::path& folder);

}  // namespace excursion
