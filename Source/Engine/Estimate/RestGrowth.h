// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/Welch.h"

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace excursion {

/// Whether what is not coherent with the input [B 2.3, figure 2.4] is noise or distortion, from how it grows in a
/// record whose level changes, as that of music does.
///
/// The response G over the whole record (see Welch.h) has an impulse response g, and leaves e = y - g * u of the
/// record, in time, where no window cuts what rings. In segments that stand side by side, all without their means, odd
/// distortion also changes the gain with the level: e = c (g * u) + rest, c one number a segment. Then
///     P = sum rest^2,  S = sum (g * u)^2,  ln P = a + b ln S
/// by least squares over the segments. Noise does not follow the signal, b = 0. Whatever is linear follows it, b = 1:
/// what rings longer than a segment of welch(), or a response that drifts. Distortion of order n grows as n, so b = 2
/// or more, and less where noise lies below it. The louder half of the segments, where noise matters least, is asked as
/// well. Noise with distortion above it may have b = 1 on the whole, but then b rises with the level: a parabola in ln
/// S tells by how much over `range`.
struct RestGrowth {
    enum class Verdict {
        noise,       ///< b is below 1/2 by two standard errors
        distortion,  ///< b is above 1 by two standard errors and 0.2, of all or of the louder half
        linear,      ///< b is 1 within 0.5, above 0 by two standard errors, and rises by less than 1, by two as well
        untold       ///< the level changes by less than 10 dB, segments are fewer than 12, or nothing of that is sure
    };
    Verdict verdict = Verdict::untold;
    double slope = 0.0, standardError = 0.0;  ///< b; an infinite error where all segments are equally loud
    bool bends = false;                       ///< b rises with the level, by two standard errors
    double range = 0.0;                       ///< dB between the quietest and the loudest tenth of S_s
    /// power of the rest over that of the output: all of it, and that in excess of what the quietest fifth leaves,
    /// which is the distortion at least where that is the verdict; -infinity where nothing is left
    double restDb = -std::numeric_limits<double>::infinity(), excessDb = restDb;
    /// 1 + c of the loudest fifth of the segments over that of the quietest; empty where one of them is not above 0
    std::optional<double> gainDb;
    int segments = 0;

    std::string sentence() const;
};

std::string_view name(RestGrowth::Verdict);  ///< "noise", "distortion", "linear", "untold"

/// Of whole records, cut as welch() cuts them with the same options. Throws Error as welch() does.
RestGrowth restGrowth(std::span<const double> input, std::span<const double> output, double sampleRate,
                      const WelchOptions& = {});
RestGrowth restGrowth(const Measurement&, Quantity output, const WelchOptions& = {});

}  // namespace excursion
