// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/Measurement.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace excursion::study {

/// One random take of the study.
struct Case {
    std::uint64_t seed = 1;
    std::vector<std::string> hidden;                   ///< ids of effects; none: a control
    double seconds = 12.0;                             ///< about, of the take
    unsigned threads = 1;                              ///< of the fits
    std::optional<std::vector<Quantity>> channels {};  ///< absent: drawn
    std::string oddity {};                             ///< what no effect describes, bench::oddityNames(); empty: none
    /// where seed/take and seed/truth.json are written for other programs to try themselves on; empty: nowhere
    std::filesystem::path keep {};
};

/// Of one law of the final model: how much of the truth lies within its 95 % band, over 90 % of the visited range.
struct LawCoverage {
    std::string effect;
    bool hidden = false;  ///< the effect is really there; else the truth is a constant
    int points = 0, inside = 0;
    double spread = 0.0;  ///< rms of its errors at the points, in standard errors
};

struct Outcome {
    Case what;
    std::string driver;
    std::vector<std::string> channels;  ///< of the take, beside the voltage
    double sampleRate = 0.0, noiseDb = 0.0, takeSeconds = 0.0, improveSeconds = 0.0;
    std::vector<double> strengths;  ///< of the hidden effects
    std::vector<double> showDb;     ///< what each changes in the channel that shows it best, over the noise
    double oddityDb = 0.0;          ///< the same of the oddity
    std::string verdict, first;     ///< first of the ranking of the base's diagnosis
    std::vector<std::string> added, withdrawn;
    std::vector<double> confidence;  ///< in each that was added, 0..1
    double standsDb = 0.0;           ///< validation error of the base over the noise floor, in the worst channel
    double finalDb = 0.0;            ///< the same of the final model
    std::vector<LawCoverage> laws;
    std::string failure;  ///< what was thrown

    bool control() const { return what.hidden.empty(); }
    /// a loudspeaker with several effects, or with known ones beside an oddity
    bool whole() const { return what.hidden.size() > 1 || (!control() && odd()); }
    bool odd() const { return !what.oddity.empty(); }
    /// The effect whose law is of the same kind as the oddity's, so that naming it is no mistake: a contact is a
    /// stiffness that depends on position, any hysteresis a friction. Empty: there is none.
    std::string kin() const;
    bool isThere(const std::string& effect) const;  ///< hidden, or kin of what is beside
    int falselyAdded() const;                       ///< effects that are neither there nor kin of what is
    /// What is there beside the known effects is not passed over in silence: not complete, or its kin is named.
    bool honest() const;
    bool hides(const std::string& effect) const;
    bool shows(std::size_t n) const;  ///< hidden effect n, 6 dB above the noise
    bool named() const { return hides(first); }
    bool nothingAdded() const;  ///< and not refused either
    /// what is hidden was added and nothing else; of several all that show, of a control none
    bool explained() const;
};

/// How far an effect stands out that counts as one to be seen, and how near to the noise a model is good, dB.
inline constexpr double standsOutDb = 6.0, nearNoiseDb = 3.0;

/// Draws the loudspeaker and its take, lets it be improved, and compares with the truth. Never throws.
Outcome run(const Case&);

}  // namespace excursion::study
