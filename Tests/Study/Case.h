// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace excursion::study {

/// One random take of the study.
struct Case {
    std::uint64_t seed = 1;
    std::vector<std::string> hidden;  ///< ids of effects; none: a control
    double seconds = 12.0;            ///< about, of the take
    unsigned threads = 1;             ///< of the fits
};

/// Of one law of the final model: how much of the truth lies within its 95 % band, over 90 % of the visited range.
struct LawCoverage {
    std::string effect;
    bool hidden = false;  ///< the effect is really there; else the truth is a constant
    int points = 0, inside = 0;
};

struct Outcome {
    Case what;
    std::string driver;
    double sampleRate = 0.0, noiseDb = 0.0, takeSeconds = 0.0, improveSeconds = 0.0;
    std::vector<double> strengths;  ///< of the hidden effects
    /// of several: what each changes in the channel that shows it best, over the noise
    std::vector<double> showDb;
    std::string verdict, first;  ///< first of the ranking of the base's diagnosis
    std::vector<std::string> added, withdrawn;
    double standsDb = 0.0;  ///< validation error of the base over the noise floor, in the worst channel
    double finalDb = 0.0;   ///< the same of the final model
    std::vector<LawCoverage> laws;
    std::string failure;  ///< what was thrown

    bool control() const { return what.hidden.empty(); }
    bool whole() const { return what.hidden.size() > 1; }  ///< a loudspeaker with several effects
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
