// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/InputOutputRecord.h"
#include "Engine/Take/Measurement.h"

#include <optional>
#include <vector>

namespace excursion {

struct InputOutputRecords {
    std::vector<InputOutputRecord> estimation, validation;
    /// of the averaged periods, by their scatter, relative to the output, without means: the floor of every error; of
    /// several periods only. What the input scatters counts as far as the output does not follow it: the averaged
    /// input, noise and all, drives every model.
    std::optional<double> noiseDb;

    /// The error in dB that a fit may be content with: 3 dB above the noise; -200 where that is not known.
    double enoughDb() const { return noiseDb ? *noiseDb + 3.0 : -200.0; }
};

/// What black-box models of one input and output are fitted to and judged by: the averaged period of every realization
/// of one level, led in by its own last samples, the last realization for validation; of a take without periods the
/// last third, led in by what comes before. The lead-in is a whole period or 2 s, whichever is less, and 0.2 s at
/// least, in which even a lightly damped resonance at 20 Hz dies away.
/// @param level  index into Excitation::levels; below 0: the last
/// Throws Error (data) as periodicExcitation() does.
InputOutputRecords recordsOf(const Measurement&, const Channel& input, const Channel& output, int level = -1);

}  // namespace excursion
