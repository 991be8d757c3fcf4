// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Document/JsonField.h"
#include "Engine/Polynomial/InputOutputRecord.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace excursion {

/// What a model without physics was fitted under, as far as it matters afterwards: such a model knows nothing beyond
/// the level and the band of its records. The field "stimulus" of a model's document keeps it.
struct Stimulus {
    double rms = 0.0;   ///< of the input, in its unit, without the mean
    double peak = 0.0;  ///< the largest magnitude of the input
    /// Hz, centres of the bands of a third of an octave that hold power, ascending; a band is what lies within 2^(1/6)
    /// of its centre
    std::vector<double> frequency;
    std::vector<double> power;  ///< of each band, in the unit's square; they sum to about rms^2

    double lowest() const;   ///< Hz, where the first band begins
    double highest() const;  ///< Hz, where the last one ends

    bool isValid(std::string* reason = nullptr) const;
};

/// Of the judged parts of the inputs, N x 1; a band whose density is 60 dB below the largest one is noise, and not
/// counted. Throws Error (data) where the inputs are silent.
Stimulus stimulusOf(const std::vector<InputOutputRecord>&, double sampleRate);

/// One period of a multisine of random phases with these bands, on odd lines of which every fourth or so is left out,
/// so that distortion shows on the others: its rms is that of the stimulus where the bands lie below half the rate.
/// @param period  samples; the band must hold some lines, else Error (usage)
/// @param lines   where not null: which lines are excited, ascending
std::vector<double> playedAs(const Stimulus&, double sampleRate, int period, std::uint64_t seed,
                             std::vector<int>* lines = nullptr);

nlohmann::ordered_json toJson(const Stimulus&);

/// Of the field "stimulus" of a model's document; none where there is none. Throws Error (input).
std::optional<Stimulus> stimulusFrom(const JsonField& document);

}  // namespace excursion
