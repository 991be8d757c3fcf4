// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/RestGrowth.h"

#include "Engine/Document/Engineering.h"
#include "Engine/Error.h"
#include "Engine/Signal/Convolution.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Level.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

namespace excursion {
namespace {

constexpr double leastRange = 10.0;  // dB
constexpr std::size_t fewestSegments = 12;

struct Portion {
    double told = 0.0, rest = 0.0, all = 0.0, gain = 0.0;  // S, P, sum y^2, c
};

/// What the response makes of the whole record, so that no segment begins or ends within it: the impulse response of G,
/// of which the last quarter is what comes before time 0, as of channels that are late.
std::vector<double> toldBy(const WelchResult& whole, std::span<const double> input)
{
    const auto lines = whole.frf.value.size();
    std::vector<std::complex<double>> response(lines + 2);
    std::copy(whole.frf.value.begin(), whole.frf.value.end(), response.begin() + 1);
    response.front() = whole.frf.value.front().real();
    response.back() = whole.frf.value.back().real();
    const std::size_t N = 2 * (lines + 1), ahead = N / 4;
    auto impulse = inverseFft(response, N);
    std::rotate(impulse.begin(), impulse.end() - static_cast<std::ptrdiff_t>(ahead), impulse.end());
    auto told = convolved(impulse, input);
    told.erase(told.begin(), told.begin() + static_cast<std::ptrdiff_t>(ahead));
    told.resize(input.size());
    return told;
}

/// Of two stretches, without their means.
double product(std::span<const double> a, std::span<const double> b)
{
    const auto N = static_cast<double>(a.size());
    double meanA = 0.0, meanB = 0.0, sum = 0.0;
    for (std::size_t t = 0; t < a.size(); ++t) {
        meanA += a[t] / N;
        meanB += b[t] / N;
    }
    for (std::size_t t = 0; t < a.size(); ++t)
        sum += (a[t] - meanA) * (b[t] - meanB);
    return sum;
}

struct Slope {
    double value = 0.0, standardError = 0.0;

    bool surelyAbove(double bound) const { return value - 2.0 * standardError > bound; }
    bool surelyBelow(double bound) const { return value + 2.0 * standardError < bound; }
};

/// Of ln P against ln S, of the portions from `first` on.
Slope slopeOf(const std::vector<Portion>& portions, std::size_t first)
{
    const auto count = static_cast<double>(portions.size() - first);
    double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
    for (std::size_t k = first; k < portions.size(); ++k) {
        x += std::log(portions[k].told) / count;
        y += std::log(portions[k].rest) / count;
    }
    for (std::size_t k = first; k < portions.size(); ++k) {
        const double dx = std::log(portions[k].told) - x, dy = std::log(portions[k].rest) - y;
        xx += dx * dx;
        xy += dx * dy;
        yy += dy * dy;
    }
    Slope slope;
    slope.value = xy / xx;
    slope.standardError = std::sqrt(std::max(yy - slope.value * xy, 0.0) / (count - 2.0) / xx);
    return slope;
}

RestGrowth::Verdict verdictOf(const Slope& all, const Slope& louder)
{
    using enum RestGrowth::Verdict;
    if (all.surelyAbove(1.2) || louder.surelyAbove(1.2))
        return distortion;
    if (all.surelyBelow(0.5) && !louder.surelyAbove(0.5))
        return noise;
    if (std::abs(all.value - 1.0) < 0.5 && all.surelyAbove(0.0))
        return linear;
    return untold;
}

}  // namespace

std::string_view name(RestGrowth::Verdict verdict)
{
    switch (verdict) {
    case RestGrowth::Verdict::noise: return "noise";
    case RestGrowth::Verdict::distortion: return "distortion";
    case RestGrowth::Verdict::linear: return "linear";
    default: return "untold";
    }
}

std::string RestGrowth::sentence() const
{
    const auto growth = "it grows with the power " + fixedText(slope, 1) + " of the signal's";
    const auto gain = " Loud passages have " + fixedText(std::abs(gainDb), 2) + " dB "
                      + (gainDb < 0.0 ? "less" : "more") + " gain than quiet ones.";
    switch (verdict) {
    case Verdict::noise: return "Mostly noise: " + growth + ", so it hardly follows the signal.";
    case Verdict::distortion:
        return "Distortion, " + fixedText(excessDb, 1) + " dB of the output: " + growth
               + " or more where it is loud, and what is linear with the power 1." + gain;
    case Verdict::linear:
        return "Neither noise nor distortion: " + growth + ", as what is linear does; longer segments may explain it."
               + gain;
    default:
        return segments < static_cast<int>(fewestSegments)
                   ? "Whether it is noise or distortion cannot be told of " + std::to_string(segments) + " segments."
               : range < leastRange ? "Whether it is noise or distortion cannot be told: the level changes by "
                                          + fixedText(range, 1) + " dB alone."
                                    : "Whether it is noise or distortion cannot be told: " + growth + ".";
    }
}

RestGrowth restGrowth(std::span<const double> input, std::span<const double> output, double sampleRate,
                      const WelchOptions& options)
{
    const auto whole = welch(input, output, sampleRate, options);
    const auto N = static_cast<std::size_t>(options.segmentOf(input.size()));
    std::vector<Portion> portions;
    Portion sum;
    const auto told = toldBy(whole, input);
    std::vector<double> rest(told.size());
    for (std::size_t t = 0; t < told.size(); ++t)
        rest[t] = output[t] - told[t];
    // The first segment rings of what was before the record, and the last is not told to its end.
    for (std::size_t start = N; start + 2 * N <= input.size(); start += N) {
        const auto segmentOf = [&](std::span<const double> x) { return x.subspan(start, N); };
        const auto e = segmentOf(rest), followed = segmentOf(told), y = segmentOf(output);
        Portion portion {product(followed, followed), product(e, e), product(y, y)};
        if (portion.told > 0.0) {
            portion.gain = product(e, followed) / portion.told;
            portion.rest -= portion.gain * portion.gain * portion.told;
        }
        sum.rest += portion.rest;
        sum.all += portion.all;
        if (portion.told > 0.0 && portion.rest > 0.0)
            portions.push_back(portion);
    }
    RestGrowth growth;
    growth.segments = static_cast<int>(portions.size());
    growth.restDb = growth.excessDb = decibelsOf(sum.rest / sum.all);
    if (portions.size() < fewestSegments)
        return growth;
    std::sort(portions.begin(), portions.end(), [](const auto& a, const auto& b) { return a.told < b.told; });
    const auto tenth = portions.size() / 10, fifth = portions.size() / 5;
    growth.range = decibelsOf(portions[portions.size() - 1 - tenth].told / portions[tenth].told);
    double quiet = 0.0, quietGain = 1.0, loudGain = 1.0;
    for (std::size_t k = 0; k < fifth; ++k) {
        quiet += portions[k].rest / static_cast<double>(fifth);
        quietGain += portions[k].gain / static_cast<double>(fifth);
        loudGain += portions[portions.size() - 1 - k].gain / static_cast<double>(fifth);
    }
    growth.gainDb = 2.0 * decibelsOf(std::max(loudGain, 0.0) / std::max(quietGain, 1e-9));
    growth.excessDb = decibelsOf(std::max(sum.rest - quiet * static_cast<double>(portions.size()), 0.0) / sum.all);
    const auto all = slopeOf(portions, 0);
    growth.slope = all.value;
    growth.standardError = all.standardError;
    if (growth.range >= leastRange)
        growth.verdict = verdictOf(all, slopeOf(portions, portions.size() / 2));
    return growth;
}

RestGrowth restGrowth(const Measurement& take, Quantity output, const WelchOptions& options)
{
    const auto* channel = take.find(output);
    if (!channel)
        throw Error(Error::Kind::data, "The take has no " + std::string(name(output)) + " channel.");
    return restGrowth(take.input().samples, channel->samples, take.sampleRate, options);
}

}  // namespace excursion
