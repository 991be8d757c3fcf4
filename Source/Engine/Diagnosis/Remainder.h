// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Compare.h"

#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// What a model leaves unexplained in one channel.
struct ChannelRemainder {
    Quantity quantity = Quantity::current;
    std::string title;  ///< "current", "impedance"
    /// "the lowest level", "level 2 of 3": where all levels together are noise, the one that stands out farthest; what
    /// follows is of it. Else empty.
    std::string level;
    double db = 0.0;  ///< error relative to the measurement, all levels
    std::optional<double> noiseFloorDb;
    /// 10 log10 of the mean |error|^2/sigma^2 over the lines: 0 if only noise is left
    std::optional<double> aboveNoiseDb;
    std::optional<double> wanderDb;  ///< as in ChannelComparison
    std::optional<double> repeats;   ///< share of the error's power that is the same in every period, 0..1
    /// Hz, the band that holds the middle 80 % of the error's power at the loudest level, or that which stands out
    double low = 0.0, high = 0.0;
    ErrorKinds kinds;  ///< at the same level
    /// dB of relative error per dB of level: n - 1 for distortion of order n, 0 for a linear error
    std::optional<double> growth;
};

/// Where in the motion the error arises: the missing force or voltage against the quantity that explains it best.
struct RemainderPlace {
    std::string residual, against;  ///< "force" against "x"
    std::string unit;               ///< unit of `from` and `to`
    double db = 0.0;                ///< the residual's rms over the rms of the drive
    double share = 0.0;           ///< share of the residual's power, 0..1, that a curve against this quantity explains
    double from = 0.0, to = 0.0;  ///< the range that holds the middle 80 % of the curve's power
};

/// The second part of a verdict: what is left after all known effects have been named.
struct Remainder {
    std::vector<ChannelRemainder> channels;  ///< the farthest above its noise first
    /// one per residual, the largest first; empty if the take shows no residual force or voltage
    std::vector<RemainderPlace> places;
    std::vector<std::string> looksLike;  ///< in words; empty if the shape is not characteristic
};

Remainder remainderOf(const Comparison&);

/// Channel, band, parity, growth, place and likeness of the first channel, as part of a sentence.
std::string inWords(const Remainder&);
/// The same without band, parity and growth, for places with little room.
std::string inFewWords(const Remainder&);
/// The sentence for something that no effect explains.
std::string unexplained(const Remainder&);

}  // namespace excursion
