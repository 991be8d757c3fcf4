// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Study/Case.h"

#include <nlohmann/json_fwd.hpp>

#include <array>
#include <map>

namespace excursion::study {

struct Share {
    int count = 0, of = 0;
    void add(bool counts)
    {
        count += counts;
        ++of;
    }
    /// Nothing to count is no failure.
    double value() const { return of > 0 ? static_cast<double>(count) / of : 1.0; }
};

/// Whether confidence means what it says: effects that were added, by the confidence in them.
struct Calibration {
    static constexpr int bins = 20;
    struct Bin {
        int right = 0, of = 0;
        double confidence = 0.0;  ///< sum
    };
    std::array<Bin, bins> byConfidence {};

    void add(double confidence, bool right);
    int count() const;
    /// sum over the bins of |right ones - sum of confidences|, over all effects
    double error() const;
};

/// The shares that the study is judged by.
struct Summary {
    Share named;      ///< takes whose effect stands 6 dB above the noise: it is first in the ranking
    Share faint;      ///< the other takes: first in the ranking, for information
    Share alone;      ///< takes of `named` whose final model has that effect and no other
    Share untouched;  ///< controls: no effect added
    Share atNoise;    ///< all: final validation error within 3 dB of the noise floor in every channel
    /// of loudspeakers with several effects: those that show, of these the ones added; added but not there
    int shown = 0, found = 0, falselyAdded = 0;
    std::map<std::string, Share> foundOf;   ///< by effect
    Share oddHonest;                        ///< takes whose oddity stands out: honest()
    Share oddNothingFalse;                  ///< takes with an oddity: no effect added that is not there
    Share inBand;                           ///< points of the hidden laws within their 95 % bands, pooled
    std::map<std::string, Share> inBandOf;  ///< by effect
    Calibration calibration;                ///< of all added effects
    double medianTimeRatio = 0.0;           ///< time of improve over the take's length

    /// Harmonic mean of the share of the shown effects that were found and of the share of the added ones that are
    /// there; 1 where there are none.
    double f1() const;
    /// named 98 %, untouched 99 %, atNoise 90 %.
    bool diagnosed() const;
    /// The same, and inBand 85 %.
    bool reached() const;
};

Summary summarize(const std::vector<Outcome>&);

std::string line(const Outcome&);  ///< one line for the terminal
/// the shares, then each take that was not as it should be
std::string text(const Summary&, const std::vector<Outcome>&);
nlohmann::ordered_json toJson(const Summary&, const std::vector<Outcome>&);

}  // namespace excursion::study
