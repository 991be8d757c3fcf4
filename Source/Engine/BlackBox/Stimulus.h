// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Document/JsonField.h"
#include "Engine/Polynomial/InputOutputRecord.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace excursion {

/// The input that a model without physics was fitted to, as far as it matters afterwards: such a model is not valid
/// beyond the level and the band of its records. The field "stimulus" of a model's document keeps it.
struct Stimulus {
    double rms = 0.0;   ///< rms of the input, in its unit, without the mean
    double peak = 0.0;  ///< the largest magnitude of the input
    /// Hz, centres of the third-octave bands that hold power, ascending; a band reaches 2^(1/6) to either side of its
    /// centre
    std::vector<double> frequency;
    std::vector<double> power;  ///< power of each band, in the square of the unit; they sum to about rms^2

    double lowest() const;   ///< Hz, where the first band begins
    double highest() const;  ///< Hz, where the last one ends

    bool isValid(std::string* reason = nullptr) const;
};

/// The stimulus of the judged parts of the inputs, N x 1. A band whose density is 60 dB below the largest one is noise,
/// and not counted. Throws Error (data) if the inputs are silent.
Stimulus stimulusOf(const std::vector<InputOutputRecord>&, double sampleRate);

/// One period of a random-phase multisine with these bands, on odd lines. About every fourth line is left out, so that
/// distortion shows there. Its rms is that of the stimulus if the bands lie below half the rate.
/// @param period  samples; the band must contain some lines, else Error (usage)
/// @param lines   if not null: which lines are excited, ascending
std::vector<double> playedAs(const Stimulus&, double sampleRate, int period, std::uint64_t seed,
                             std::vector<int>* lines = nullptr);

/// How long such a period is at a rate: a power of two from 4096 samples on, until four lines lie below the lowest
/// frequency of the stimulus; 65536 at most.
int periodFor(const Stimulus&, double sampleRate);

nlohmann::ordered_json toJson(const Stimulus&);

/// Reads the field "stimulus" of a model's document; none if it is absent. Throws Error (input).
std::optional<Stimulus> stimulusFrom(const JsonField& document);

}  // namespace excursion
