// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/InputOutputRecord.h"
#include "Engine/Take/Measurement.h"

#include <optional>
#include <vector>

namespace excursion {

struct InputOutputRecords {
    std::vector<InputOutputRecord> estimation, validation;
    /// of the averaged periods, by their scatter, relative to the output: the floor of every error; of several periods
    /// only
    std::optional<double> noiseDb;

    /// The error in dB that a fit may be content with: 3 dB above the noise; -200 where that is not known.
    double enoughDb() const { return noiseDb ? *noiseDb + 3.0 : -200.0; }
};

/// What black-box models of one input and output are fitted to and judged by: the averaged period of every realization
/// of one level, led in by 0.2 s of its own last samples or more, the last realization for validation; of a take
/// without periods the last third, led in by what comes before.
/// @param level  index into Excitation::levels; below 0: the last
/// Throws Error (data) as periodicExcitation() does.
InputOutputRecords recordsOf(const Measurement&, const Channel& input, const Channel& output, int level = -1);

}  // namespace excursion
