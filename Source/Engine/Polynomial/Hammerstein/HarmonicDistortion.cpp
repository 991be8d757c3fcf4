// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Hammerstein/HarmonicDistortion.h"

#include "Engine/Error.h"
#include "Engine/Polynomial/Hammerstein/SweepBlocks.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Level.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace excursion {
namespace {

using Eigen::Index;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr double seldom = 4.6;          // times the mean of a power of noise: exceeded once in a hundred
constexpr double takenOff = 0.01;       // of the drive's own harmonics, in power, that may be left
constexpr double highestOfRate = 0.45;  // of the sample rate: where converters' filters begin

/// The mean over three lines of an even grid and more, in bands of the relative width.
std::vector<double> smoothedPower(const std::vector<double>& power, double octaves)
{
    std::vector<double> sums(power.size() + 1, 0.0);
    for (std::size_t k = 0; k < power.size(); ++k)
        sums[k + 1] = sums[k] + power[k];
    const double factor = std::exp2(octaves / 2.0);
    std::vector<double> result(power.size());
    for (std::size_t k = 0; k < power.size(); ++k) {
        const auto centre = static_cast<double>(k);
        const auto first = std::min(k > 0 ? k - 1 : 0, static_cast<std::size_t>(centre / factor));
        const auto last = std::min(power.size() - 1, std::max(k + 1, static_cast<std::size_t>(centre * factor)));
        result[k] = (sums[last + 1] - sums[first]) / static_cast<double>(last + 1 - first);
    }
    return result;
}

/// The mean of a power over the lines within half a point of a frequency; between two lines where there are fewer.
class LineMeans {
public:
    LineMeans(double step, double pointsPerOctave) : step_(step), half_(std::exp2(0.5 / pointsPerOctave)) {}

    double operator()(const std::vector<double>& power, double frequency) const
    {
        const auto first = static_cast<std::size_t>(std::ceil(frequency / half_ / step_)),
                   last = static_cast<std::size_t>(std::floor(frequency * half_ / step_));
        if (last >= power.size())
            return unknown;
        if (last >= first + 1)
            return std::accumulate(power.begin() + static_cast<std::ptrdiff_t>(first),
                                   power.begin() + static_cast<std::ptrdiff_t>(last) + 1, 0.0)
                   / static_cast<double>(last - first + 1);
        const double line = frequency / step_;
        const auto below = std::min(static_cast<std::size_t>(line), power.size() - 2);
        const double part = line - static_cast<double>(below);
        return (1.0 - part) * power[below] + part * power[below + 1];
    }
    double halfWidth() const { return half_; }

private:
    double step_, half_;
};

/// What one channel answered at one level.
struct Answer {
    HarmonicResponses harmonics;
    std::vector<std::vector<double>> noise;  ///< [m-1][line], power of H_m that is noise; empty: not known
};

/// Mean power under the window of a response in the silence, from where the last response has died away.
std::vector<double> silentPower(const SweepBlocks& blocks, const std::vector<double>& mean, std::size_t kept,
                                std::size_t lines)
{
    const auto begin = static_cast<std::size_t>(blocks.plan.sweepSamples(blocks.rate())) + kept;
    if (begin + kept > mean.size())
        return {};
    const auto silence = std::span(mean).subspan(begin);
    const double offset = std::accumulate(silence.begin(), silence.end(), 0.0) / static_cast<double>(silence.size());
    const auto grid = 2 * (lines - 1), fade = static_cast<std::size_t>(std::ceil(sweepWindowEdge * blocks.rate()));
    std::vector<double> power(lines, 0.0);
    std::size_t parts = 0;
    for (std::size_t at = 0; at + kept <= silence.size(); at += std::max<std::size_t>(1, kept / 2), ++parts) {
        std::vector<double> part(grid, 0.0);
        for (std::size_t n = 0; n < kept; ++n)
            part[n] = sweepWindow(n, kept, fade) * (silence[at + n] - offset);
        const auto spectrum = fft(part);
        for (std::size_t k = 0; k < lines; ++k)
            power[k] += std::norm(spectrum[k]);
    }
    for (auto& value : power)
        value /= static_cast<double>(parts);
    return power;
}

Answer answerOf(const SweepBlocks& blocks, const Channel& channel, std::size_t level,
                const HammersteinSweepOptions& cut)
{
    const auto sweep = blocks.plan.sweep(blocks.rate(), level);
    const auto mean = blocks.mean(channel, level);
    Answer answer;
    answer.harmonics = harmonicResponses(sweep, mean, cut);
    const auto& frequency = answer.harmonics.frequency;
    const auto kept = static_cast<std::size_t>(cut.length)
                      + 2 * static_cast<std::size_t>(std::ceil(sweepWindowEdge * blocks.rate()));
    if (auto power = silentPower(blocks, mean, kept, frequency.size()); !power.empty()) {
        power[0] = 0.0;
        for (std::size_t k = 1; k < power.size(); ++k)
            power[k] /= blocks.rate() * blocks.rate() * std::norm(sweep.spectrum(frequency[k]));
        answer.noise.assign(static_cast<std::size_t>(cut.degree), smoothedPower(power, 1.0 / 3.0));
    }
    if (const int R = blocks.plan.repeats; R > 1) {
        std::vector<std::vector<double>> scatter(static_cast<std::size_t>(cut.degree),
                                                 std::vector<double>(frequency.size(), 0.0));
        for (int r = 0; r < R; ++r) {
            const auto one = blocks.block(channel, level, r);
            std::vector<double> difference(one.begin(), one.end());
            for (std::size_t n = 0; n < mean.size(); ++n)
                difference[n] -= mean[n];
            const auto D = harmonicResponses(sweep, difference, cut);
            for (std::size_t m = 0; m < scatter.size(); ++m)
                for (std::size_t k = 0; k < frequency.size(); ++k)
                    scatter[m][k] += std::norm(D.value(static_cast<Index>(k), static_cast<Index>(m))) / (R * (R - 1.0));
        }
        for (auto& power : scatter)
            power = smoothedPower(power, 1.0 / 3.0);
        if (answer.noise.empty())
            answer.noise = scatter;
        for (std::size_t m = 0; m < scatter.size(); ++m)
            for (std::size_t k = 0; k < frequency.size(); ++k)
                answer.noise[m][k] = std::max(answer.noise[m][k], scatter[m][k]);
    }
    return answer;
}

/// Power of the fundamental that the method finds in the sweep itself, one a line: 1 but near the ends, where the
/// window of a response smears them.
std::vector<double> foundInSweep(const SweepBlocks& blocks, const HammersteinSweepOptions& cut)
{
    const auto sweep = blocks.plan.sweep(blocks.rate(), 0);
    auto x = sweep.samples();
    x.resize(blocks.length, 0.0);
    const auto found = harmonicResponses(sweep, x, cut);
    std::vector<double> power;
    for (Index k = 0; k < found.value.rows(); ++k)
        power.push_back(std::norm(found.value(k, 0)));
    return power;
}

/// @param drive  null for the drive itself
/// @param own    foundInSweep()
HarmonicCurves curvesOf(const Answer& answer, const Answer* drive, double level, const SweepBand& band,
                        const std::vector<double>& own, const HarmonicOptions& options)
{
    const auto& H = answer.harmonics;
    const double step = H.frequency[1], nyquist = highestOfRate * H.sampleRate;
    const LineMeans at(step, options.pointsPerOctave);
    const auto lines = H.frequency.size();
    const auto N = static_cast<std::size_t>(options.highest);
    const bool noisy = !answer.noise.empty() && (!drive || !drive->noise.empty());

    // Powers of each harmonic, of what was taken off it, and of noise, on the lines of the harmonic's own frequency.
    std::vector<std::vector<double>> power(N, std::vector<double>(lines)), left(power), noise(power);
    for (std::size_t m = 0; m < N; ++m)
        for (std::size_t k = 1; k < lines; ++k) {
            const auto line = static_cast<Index>(k), column = static_cast<Index>(m);
            auto value = H.value(line, column);
            if (noisy)
                noise[m][k] = answer.noise[m][k];
            const bool played = H.frequency[k] >= band.low && H.frequency[k] <= band.high;
            if (drive && m > 0 && played) {
                const auto G = H.value(line, 0) / drive->harmonics.value(line, 0);
                const auto passed = G * drive->harmonics.value(line, column);
                value -= passed;
                left[m][k] = takenOff * std::norm(passed);
                if (noisy)
                    noise[m][k] += std::norm(G) * drive->noise[m][k];
            }
            power[m][k] = std::norm(value);
        }

    HarmonicCurves curves;
    curves.level = level;
    const double points = options.pointsPerOctave;
    const auto from = std::ceil(points * std::log2(band.low * at.halfWidth() / 1000.0)),
               to = std::floor(points * std::log2(band.high / at.halfWidth() / 1000.0));
    for (double i = from; i <= to; ++i)
        curves.frequency.push_back(1000.0 * std::exp2(i / points));
    const auto rows = static_cast<Index>(curves.frequency.size());
    curves.db = Eigen::MatrixXd::Constant(rows, options.highest - 1, unknown);
    curves.floorDb = curves.db;
    for (Index i = 0; i < rows; ++i) {
        const double f = curves.frequency[static_cast<std::size_t>(i)];
        const double fundamental = at(power[0], f) / at(own, f);
        curves.fundamental.push_back(std::sqrt(fundamental) * level);
        double sum = 0.0, floors = 0.0;
        const bool heard = fundamental > seldom * (noisy ? at(noise[0], f) : 0.0);
        for (std::size_t m = 1; heard && m < N; ++m) {
            const double F = static_cast<double>(m + 1) * f;
            if (F * at.halfWidth() > nyquist)
                break;
            const double mean = at(noise[m], F), floor = seldom * mean + at(left[m], F), found = at(power[m], F);
            const auto column = static_cast<Index>(m) - 1;
            if (noisy) {
                curves.floorDb(i, column) = decibelsOf(floor / fundamental);
                floors += floor;
            }
            if (found > floor && found > mean) {
                curves.db(i, column) = decibelsOf((found - mean) / fundamental);
                sum += found - mean;
            }
        }
        curves.thdDb.push_back(sum > 0.0 ? decibelsOf(sum / fundamental) : unknown);
        curves.thdFloorDb.push_back(floors > 0.0 ? decibelsOf(floors / fundamental) : unknown);
    }
    return curves;
}

}  // namespace

bool HarmonicOptions::isValid(std::string* reason) const
{
    if (highest < 2 || highest > 20)
        return refuse(reason, "the highest harmonic must be 2 to 20");
    if (!(pointsPerOctave >= 1.0 && pointsPerOctave <= 96.0))
        return refuse(reason, "a curve has 1 to 96 points an octave");
    return true;
}

HarmonicDistortion harmonicDistortion(const SweepTake& sweepTake, const HarmonicOptions& options,
                                      const Progress& progress)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "Harmonics cannot be told apart: " + reason + ".");
    const SweepBlocks blocks(sweepTake);
    const auto& take = sweepTake.take;
    const auto& input = take.input();
    const auto cut = cutting(blocks, options.highest);
    const auto sweep = blocks.plan.sweep(blocks.rate(), 0);
    auto ends = cut;
    ends.length = 1;  // the fundamental's end rings behind it, where no harmonic is
    auto band = knownBand(sweep, ends);
    HarmonicDistortion result;
    result.highest = options.highest;
    result.response = static_cast<double>(cut.length) / blocks.rate() + 2.0 * sweepWindowEdge;
    band.low += 1.0 / result.response;
    band.high -= 1.0 / result.response;
    if (!(band.low * 2.0 < band.high))
        throw Error(Error::Kind::data, "The sweeps are too narrow: less than an octave of them is not faded.");
    result.bandLow = band.low;
    result.bandHigh = band.high;

    const auto own = foundInSweep(blocks, cut);
    const auto levels = blocks.plan.levels.size();
    std::vector<std::vector<HarmonicCurves>> byChannel(take.channels.size());
    bool noisy = true;
    for (std::size_t level = 0; level < levels; ++level) {
        const auto drive = answerOf(blocks, input, level, cut);
        noisy = noisy && !drive.noise.empty();
        for (std::size_t c = 0; c < take.channels.size(); ++c) {
            progress.at(static_cast<double>(level * take.channels.size() + c)
                            / static_cast<double>(levels * take.channels.size()),
                        "taking harmonics apart");
            const auto& channel = take.channels[c];
            const bool itself = &channel == &input;
            if (itself && channel.assumed)
                continue;
            auto curves = itself ? curvesOf(drive, nullptr, blocks.plan.levels[level], band, own, options)
                                 : curvesOf(answerOf(blocks, channel, level, cut), &drive, blocks.plan.levels[level],
                                            band, own, options);
            curves.quantity = channel.quantity;
            curves.unit = channel.unit;
            byChannel[c].push_back(std::move(curves));
        }
    }
    for (auto& curves : byChannel)
        std::move(curves.begin(), curves.end(), std::back_inserter(result.curves));
    if (!noisy)
        result.remarks.emplace_back(
            "The silence behind the sweeps is too short to tell the noise, and none is repeated: what is shown may be "
            "noise. Play a second of silence, or each sweep twice.");
    return result;
}

}  // namespace excursion
