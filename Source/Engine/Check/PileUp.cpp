// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Check/PileUp.h"

#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace excursion {
namespace {

/// Samples of one level behind one another, and what their repetitions say of their noise.
struct Strip {
    std::vector<double> values;
    std::vector<double> variance;     ///< of each value; empty: unknown
    std::vector<std::size_t> places;  ///< in time; realizations lie far apart
    double resolution = 0.0;          ///< smallest step of the record
};

constexpr std::size_t apart = 1000;
constexpr std::size_t sameTop = 4;    ///< noise makes holes of this many samples
constexpr double reach = 0.35;        ///< of the way from the extreme to the median, that is looked at
constexpr double finestScale = 1e-9;  ///< of that way
constexpr double scaleStep = 1.25;

double smallestStep(const std::vector<double>& x)
{
    double finest = std::numeric_limits<double>::infinity();
    for (std::size_t n = 1; n < x.size(); ++n)
        if (const double step = std::abs(x[n] - x[n - 1]); step > 0.0)
            finest = std::min(finest, step);
    return finest;
}

Strip averagedLevel(const AveragedPeriods& averages, const Channel& channel, int level)
{
    const Excitation& e = averages.excitation();
    const auto period = static_cast<std::size_t>(e.period), periods = static_cast<std::size_t>(e.periods);
    Strip strip;
    for (int m = 0; m < e.realizations; ++m) {
        const auto used = usedPeriods(averages.take(), channel, level, m);
        const auto& mean = averages.inTime(channel, level, m);
        for (std::size_t n = 0; n < period; ++n) {
            double square = 0.0;
            for (std::size_t p = 0; p < periods; ++p)
                square += (used[p * period + n] - mean[n]) * (used[p * period + n] - mean[n]);
            strip.values.push_back(mean[n]);
            strip.variance.push_back(square / (e.periods * (e.periods - 1.0)));
            strip.places.push_back(static_cast<std::size_t>(m) * (period + apart) + n);
        }
    }
    return strip;
}

Strip wholeRecord(const Channel& channel)
{
    Strip strip;
    strip.values = channel.samples;
    for (std::size_t n = 0; n < strip.values.size(); ++n)
        strip.places.push_back(n);
    return strip;
}

/// The samples near one extreme, the outermost first, by their distance from it.
class Edge {
public:
    Edge(const Strip& strip, bool high)
    {
        const double sign = high ? 1.0 : -1.0;
        auto sorted = strip.values;
        for (double& value : sorted)
            value *= sign;
        const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
        std::nth_element(sorted.begin(), middle, sorted.end());
        extreme_ = *std::max_element(middle, sorted.end());
        way_ = extreme_ - *middle;
        for (std::size_t n = 0; n < strip.values.size(); ++n)
            if (const double distance = extreme_ - sign * strip.values[n]; distance <= reach * way_)
                near_.push_back({distance, n});
        std::sort(near_.begin(), near_.end(), [](const Near& a, const Near& b) { return a.distance < b.distance; });
    }

    /// From the extreme to the median.
    double way() const { return way_; }

    std::size_t within(double distance) const
    {
        return static_cast<std::size_t>(
            std::upper_bound(near_.begin(), near_.end(), distance,
                             [](double d, const Near& sample) { return d < sample.distance; })
            - near_.begin());
    }

    double distanceOf(std::size_t rank) const { return rank < near_.size() ? near_[rank].distance : way_; }

    /// Indices into the strip of the `count` outermost samples, in time.
    std::vector<std::size_t> outermost(std::size_t count) const
    {
        std::vector<std::size_t> indices;
        for (std::size_t n = 0; n < count; ++n)
            indices.push_back(near_[n].index);
        std::sort(indices.begin(), indices.end());
        return indices;
    }

private:
    struct Near {
        double distance;
        std::size_t index;
    };
    double extreme_ = 0.0, way_ = 0.0;
    std::vector<Near> near_;
};

struct Bump {
    double mean = 0.0, variance = 0.0;
    double noise = 0.0;       ///< variance by the scatter of the periods
    double neighbours = 0.0;  ///< von Neumann's ratio
    std::size_t pairs = 0;    ///< of neighbours
    std::size_t tops = 1;
    std::size_t inStretches = 0;  ///< samples in stretches of three or more
};

Bump bumpOf(const Strip& strip, const std::vector<std::size_t>& members)
{
    Bump bump;
    const auto count = static_cast<double>(members.size());
    for (const auto n : members)
        bump.mean += strip.values[n] / count;
    for (const auto n : members) {
        bump.variance += (strip.values[n] - bump.mean) * (strip.values[n] - bump.mean) / (count - 1.0);
        if (!strip.variance.empty())
            bump.noise += strip.variance[n] / count;
    }
    std::size_t stretch = 1;
    for (std::size_t i = 1; i <= members.size(); ++i) {
        const auto step = i < members.size() ? strip.places[members[i]] - strip.places[members[i - 1]] : apart;
        if (step == 1) {
            const double change = strip.values[members[i]] - strip.values[members[i - 1]];
            bump.neighbours += change * change;
            ++bump.pairs;
            ++stretch;
            continue;
        }
        if (stretch >= 3)
            bump.inStretches += stretch;
        stretch = 1;
        bump.tops += i < members.size() && step > sameTop;
    }
    bump.neighbours /= std::max(1.0, static_cast<double>(bump.pairs)) * bump.variance;
    return bump;
}

enum class Noise { no, likely, certain };

/// Whether nothing but noise makes the samples of the bump differ.
Noise noiseOf(const Bump& bump, std::size_t count, bool repeated)
{
    constexpr std::size_t enoughPairs = 16, enoughSamples = 60;
    if (!(bump.variance > 0.0) || (bump.pairs >= enoughPairs && bump.neighbours < 1.3))
        return Noise::no;
    if (!repeated)
        return bump.pairs >= enoughPairs && 2 * bump.inStretches > count ? Noise::likely : Noise::no;
    const double ratio = bump.variance / bump.noise;
    const double error = std::sqrt(2.0 / static_cast<double>(count));
    if (!(ratio > 0.3 && ratio < 1.5 + 2.0 * error))
        return Noise::no;
    const bool alone = bump.pairs < enoughPairs || bump.neighbours > 2.0 - 3.5 * error;
    return count >= enoughSamples && ratio > 0.5 && ratio < 1.0 + 2.5 * error && alone ? Noise::certain : Noise::likely;
}

/// Below the bump the samples are spread as if nothing happened, not as on a top that is flat at every scale.
bool isSpreadBelow(const Edge& edge, double width)
{
    constexpr std::size_t enough = 8;
    std::size_t counts[3] {};
    for (; 9.0 * width <= reach * edge.way(); width *= 3.0) {
        double outer = width;
        for (auto& count : counts) {
            count = edge.within(3.0 * outer) - edge.within(outer);
            outer *= 3.0;
        }
        if (counts[0] < enough)
            continue;
        const auto first = static_cast<double>(counts[0]), second = static_cast<double>(counts[1]);
        // Two intervals further out are steadier than one, where they are seen.
        return outer <= reach * edge.way() ? second + static_cast<double>(counts[2]) > 4.5 * first
                                           : second > 1.5 * first;
    }
    return false;
}

/// How far the crowd in the bump exceeds what a natural top may have; above 1: clipping.
double excess(std::size_t inside, std::size_t beside, std::size_t tops, Noise noise)
{
    const double crowd = 2.0 * static_cast<double>(inside) / (static_cast<double>(beside) + 3.0);
    const double fewTops = 1.0 / static_cast<double>(tops);
    return crowd / (noise == Noise::certain ? 3.2 * (1.0 + 0.6 * fewTops) : 6.0 * (1.0 + 1.5 * fewTops));
}

std::optional<PileUp> pileAt(const Strip& strip, bool high)
{
    constexpr std::size_t fewest = 8;
    if (strip.values.size() < 64)
        return std::nullopt;
    const Edge edge(strip, high);
    const bool repeated = !strip.variance.empty();
    const auto all = strip.values.size();
    std::optional<PileUp> found;
    double most = 1.0;
    double width = std::max({edge.distanceOf(fewest - 1), finestScale * edge.way(), 4.0 * strip.resolution});
    for (; 9.0 * width <= reach * edge.way() && edge.way() > 0.0; width *= scaleStep) {
        const auto inside = edge.within(width), beside = edge.within(3.0 * width) - inside;
        const auto below = edge.within(width + 0.25 * edge.way()) - inside;
        // All tops apart: what cannot be enough then need not be looked at.
        if (5 * inside > all || 2 * below < inside || excess(inside, beside, inside, Noise::certain) <= most)
            continue;
        const auto bump = bumpOf(strip, edge.outermost(inside));
        // Without periods one top that repeats looks like many.
        const auto noise = noiseOf(bump, inside, repeated);
        const double by = excess(inside, beside, repeated ? bump.tops : 1, noise);
        if (noise == Noise::no || by <= most || !isSpreadBelow(edge, width))
            continue;
        most = by;
        found = PileUp {0, high, bump.mean, std::sqrt(bump.variance), static_cast<long>(inside)};
    }
    return found;
}

/// The wave comes again after a part of `values`: tops and the gaps between them are then one, seen many times. By the
/// autocorrelation over the signal's power, beyond where it has first fallen to a half.
/// @param cyclic  `values` are one period, else they are followed by silence
bool repeatsWithin(std::vector<double> values, bool cyclic)
{
    constexpr double alike = 0.95;  // of a record: 20 repetitions
    const std::size_t count = values.size();
    double mean = 0.0;
    for (const double value : values)
        mean += value / static_cast<double>(count);
    for (double& value : values)
        value -= mean;
    if (!cyclic)
        values.resize(2 * count);
    auto spectrum = fft(values);
    for (auto& line : spectrum)
        line = std::norm(line);
    const auto correlation = inverseFft(spectrum, values.size());
    std::size_t lag = 1;
    while (lag <= count / 2 && correlation[lag] > 0.5 * correlation[0])
        ++lag;
    for (; lag <= count / 2; ++lag)
        if (correlation[lag] > alike * correlation[0])
            return true;
    return false;
}

bool hasPeriods(const Measurement& take)
{
    return take.excitation && take.excitation->period > 1 && take.excitation->periods > 1
           && !take.excitation->levels.empty() && take.excitation->realizations > 0
           && take.excitation->totalSamples() <= static_cast<long>(take.length());
}

}  // namespace

std::vector<PileUp> pileUps(const AveragedPeriods& averages, const Channel& channel)
{
    const auto& take = averages.take();
    std::vector<PileUp> found;
    const bool repeated = hasPeriods(take);
    const int levels = repeated ? static_cast<int>(take.excitation->levels.size()) : 1;
    const double resolution = smallestStep(channel.samples);
    for (int level = 0; level < levels; ++level) {
        auto strip = repeated ? averagedLevel(averages, channel, level) : wholeRecord(channel);
        strip.resolution = resolution;
        std::vector<PileUp> ofLevel;
        for (const bool high : {true, false})
            if (auto pile = pileAt(strip, high)) {
                pile->level = level;
                pile->samples *= repeated ? take.excitation->periods : 1;
                ofLevel.push_back(*pile);
            }
        if (ofLevel.empty())
            continue;
        if (repeated)
            strip.values.resize(static_cast<std::size_t>(take.excitation->period));  // one realization tells
        if (!repeatsWithin(std::move(strip.values), repeated))
            found.insert(found.end(), ofLevel.begin(), ofLevel.end());
    }
    return found;
}

}  // namespace excursion
