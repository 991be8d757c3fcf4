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
#include <limits>
#include <numbers>
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

struct Point {
    double x, y;
};

/// (ln S, ln P) of the portions from `first` on, about their mean.
std::vector<Point> pointsOf(std::span<const Portion> portions, std::size_t first)
{
    std::vector<Point> points;
    Point mean {0.0, 0.0};
    for (const auto& portion : portions.subspan(first)) {
        points.push_back({std::log(portion.told), std::log(portion.rest)});
        mean.x += points.back().x;
        mean.y += points.back().y;
    }
    for (auto& point : points) {
        point.x -= mean.x / static_cast<double>(points.size());
        point.y -= mean.y / static_cast<double>(points.size());
    }
    return points;
}

/// Of the line through points. Where they all have the same x it says nothing.
Slope slopeOf(const std::vector<Point>& points)
{
    double xx = 0.0, xy = 0.0, yy = 0.0;
    for (const auto& [x, y] : points) {
        xx += x * x;
        xy += x * y;
        yy += y * y;
    }
    if (!(xx > 0.0))
        return {0.0, std::numeric_limits<double>::infinity()};
    const double slope = xy / xx;
    return {slope, std::sqrt(std::max(yy - slope * xy, 0.0) / (static_cast<double>(points.size()) - 2.0) / xx)};
}

/// By how much the slope rises over a range of x, by the parabola through the same points.
Slope riseOf(const std::vector<Point>& points, double range)
{
    const auto count = static_cast<double>(points.size());
    double xx = 0.0, xxx = 0.0;
    for (const auto& [x, y] : points) {
        xx += x * x;
        xxx += x * x * x;
    }
    const double slope = slopeOf(points).value;
    double qq = 0.0, qy = 0.0, left = 0.0;
    for (const auto& [x, y] : points) {
        const double q = x * x - xx / count - xxx / xx * x, above = y - slope * x;  // what a line leaves of both
        qq += q * q;
        qy += q * above;
        left += above * above;
    }
    if (!(qq > 0.0))
        return {0.0, std::numeric_limits<double>::infinity()};
    const double bend = qy / qq;
    return {2.0 * range * bend, 2.0 * range * std::sqrt(std::max(left - bend * qy, 0.0) / (count - 3.0) / qq)};
}

RestGrowth::Verdict verdictOf(const Slope& all, const Slope& louder, const Slope& rise)
{
    using enum RestGrowth::Verdict;
    if (all.surelyAbove(1.2) || louder.surelyAbove(1.2))
        return distortion;
    if (all.surelyBelow(0.5) && !louder.surelyAbove(0.5))
        return noise;
    // Noise below and distortion above it may have the slope 1 between them.
    if (std::abs(all.value - 1.0) < 0.5 && all.surelyAbove(0.0) && rise.surelyBelow(1.0))
        return linear;
    return untold;
}

/// 20 log10; empty where there is no positive ratio.
std::optional<double> gainDbOf(double loud, double quiet)
{
    if (!(loud > 0.0 && quiet > 0.0))
        return std::nullopt;
    return 2.0 * decibelsOf(loud / quiet);
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
    const auto gain = !gainDb ? std::string()
                              : " Loud passages have " + fixedText(std::abs(*gainDb), 2) + " dB "
                                    + (*gainDb < 0.0 ? "less" : "more") + " gain than quiet ones.";
    const auto amount = std::isfinite(excessDb) ? ", " + fixedText(excessDb, 1) + " dB of the output" : std::string();
    const auto unsure = std::string("Whether it is noise or distortion cannot be told");
    switch (verdict) {
    case Verdict::noise: return "Mostly noise: " + growth + ", so it hardly follows the signal.";
    case Verdict::distortion:
        return "Distortion" + amount + ": " + growth + " or more where it is loud, and what is linear with the power 1."
               + gain;
    case Verdict::linear:
        return "Neither noise nor distortion: " + growth + ", as what is linear does; longer segments may explain it."
               + gain;
    default:
        if (segments < static_cast<int>(fewestSegments))
            return unsure + " of " + std::to_string(segments) + " segments.";
        if (range < leastRange)
            return unsure + ": the level changes by " + fixedText(range, 1) + " dB alone.";
        return unsure + ": " + growth
               + (bends ? ", and faster where it is loud, as noise with distortion above it does." : ".");
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
            portion.rest = std::max(portion.rest - portion.gain * portion.gain * portion.told, 0.0);
        }
        sum.rest += portion.rest;
        sum.all += portion.all;
        if (portion.told > 0.0 && portion.rest > 0.0)
            portions.push_back(portion);
    }
    RestGrowth growth;
    growth.segments = static_cast<int>(portions.size());
    if (sum.rest > 0.0 && sum.all > 0.0)
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
    growth.gainDb = gainDbOf(loudGain, quietGain);
    growth.excessDb = decibelsOf(std::max(sum.rest - quiet * static_cast<double>(portions.size()), 0.0) / sum.all);
    const auto points = pointsOf(portions, 0);
    const auto all = slopeOf(points), rise = riseOf(points, 0.1 * std::numbers::ln10 * growth.range);
    growth.slope = all.value;
    growth.standardError = all.standardError;
    growth.bends = rise.surelyAbove(0.0);
    if (growth.range >= leastRange)
        growth.verdict = verdictOf(all, slopeOf(pointsOf(portions, portions.size() / 2)), rise);
    return growth;
}

RestGrowth restGrowth(const Measurement& take, Quantity output, const WelchOptions& options)
{
    return restGrowth(take.input().samples, take.channel(output).samples, take.sampleRate, options);
}

}  // namespace excursion
