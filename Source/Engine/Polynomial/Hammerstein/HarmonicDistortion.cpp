// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Hammerstein/HarmonicDistortion.h"

#include "Engine/Document/Figures.h"
#include "Engine/Error.h"
#include "Engine/Polynomial/InputOutputRecord.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Level.h"
#include "Engine/Take/SweepTake.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

namespace excursion {
namespace {

using Eigen::Index;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr double seldom = 4.6;           // times the mean of a power of noise: exceeded once in a hundred
constexpr double takenOff = 0.01;        // of the drive's own harmonics, in power, that may be left
constexpr double longestResponse = 0.5;  // s of a response
constexpr double highestOfRate = 0.45;   // of the sample rate: where converters' filters begin
constexpr double windowEdge = 0.02;      // s, see HammersteinSweepOptions

/// A take of sweeps, cut into blocks.
class SweepBlocks {
public:
    explicit SweepBlocks(const SweepTake& sweepTake) : take_(sweepTake.take)
    {
        if (!sweepTake.sweep)
            throw Error(Error::Kind::data,
                        "The take does not say which sweeps it was played with, so harmonics cannot be told apart by "
                        "their time; play a plan of 'excursion excite --sweep', and import the recording with it.");
        plan = *sweepTake.sweep;
        std::string reason;
        if (!plan.isValid(take_.sampleRate, &reason))
            throw Error(Error::Kind::data, "The sweeps of the take make no sense. " + reason);
        length = static_cast<std::size_t>(plan.blockSamples(take_.sampleRate));
        if (static_cast<std::size_t>(plan.totalSamples(take_.sampleRate)) > take_.length())
            throw Error(Error::Kind::data, "The take is shorter than its sweeps.");
    }

    std::span<const double> block(const Channel& channel, std::size_t level, int repeat) const
    {
        const auto index = level * static_cast<std::size_t>(plan.repeats) + static_cast<std::size_t>(repeat);
        return std::span(channel.samples).subspan(index * length, length);
    }

    std::vector<double> mean(const Channel& channel, std::size_t level) const
    {
        std::vector<double> sum(length, 0.0);
        for (int r = 0; r < plan.repeats; ++r) {
            const auto one = block(channel, level, r);
            for (std::size_t n = 0; n < length; ++n)
                sum[n] += one[n] / plan.repeats;
        }
        return sum;
    }

    double rate() const { return take_.sampleRate; }

    SweepExcitation plan;
    std::size_t length = 0;

private:
    const Measurement& take_;
};

/// As many taps as the harmonics' distance allows, that of the first one that is not asked for included, and the
/// silence, half of which is left to tell the noise.
HammersteinSweepOptions cutting(const SweepBlocks& blocks, const HarmonicOptions& options)
{
    const auto L = blocks.plan.sweep(blocks.rate(), 0).rate();
    const double apart = L * std::log((options.highest + 1.0) / options.highest);
    double kept = std::min(apart, longestResponse);
    if (blocks.plan.silence >= 8.0 * windowEdge)
        kept = std::min(kept, blocks.plan.silence / 2.0);
    if (kept < 3.0 * windowEdge)
        throw Error(Error::Kind::data,
                    "The sweeps are too short to keep " + std::to_string(options.highest)
                        + " harmonics apart: the last two come " + figure(1e3 * apart, "%.0f")
                        + " ms apart, and a response needs 60 ms; ask for fewer harmonics, or play longer sweeps.");
    HammersteinSweepOptions result;
    result.degree = options.highest;
    result.edge = windowEdge;
    const double taps = (kept - 2.0 * windowEdge) * blocks.rate() - 4.0;
    result.length = static_cast<Index>(std::clamp(taps, 1.0, 65536.0));
    return result;
}

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
    const auto grid = 2 * (lines - 1), fade = static_cast<std::size_t>(std::ceil(windowEdge * blocks.rate()));
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
                      + 2 * static_cast<std::size_t>(std::ceil(windowEdge * blocks.rate()));
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
    const auto cut = cutting(blocks, options);
    const auto sweep = blocks.plan.sweep(blocks.rate(), 0);
    auto ends = cut;
    ends.length = 1;  // the fundamental's end rings behind it, where no harmonic is
    auto band = knownBand(sweep, ends);
    HarmonicDistortion result;
    result.highest = options.highest;
    result.response = static_cast<double>(cut.length) / blocks.rate() + 2.0 * windowEdge;
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

SweepModel sweepModel(const SweepTake& sweepTake, Quantity output, const HarmonicOptions& options)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "A model of the sweeps cannot be made: " + reason + ".");
    const SweepBlocks blocks(sweepTake);
    const auto* channel = sweepTake.take.find(output);
    const auto& input = sweepTake.take.input();
    if (!channel || channel == &input)
        throw Error(Error::Kind::data,
                    "The take has no channel \"" + std::string(name(output)) + "\" beside its input.");
    auto cut = cutting(blocks, options);
    cut.length = std::clamp<Index>(cut.length, 128, 8192);
    const auto levels = blocks.plan.levels.size();
    const auto loudest = blocks.plan.sweep(blocks.rate(), levels - 1);
    const auto band = knownBand(loudest, cut);
    const auto timeOf = [&](double f) {
        return static_cast<Index>(loudest.rate() * std::log(f / blocks.plan.bandLow) * blocks.rate());
    };
    const Index from = timeOf(options.highest * band.low + 1.0 / windowEdge), to = timeOf(band.high - 1.0 / windowEdge);
    if (to <= from)
        throw Error(Error::Kind::data, "The sweeps are too narrow, or too short, for a model of degree "
                                           + std::to_string(options.highest)
                                           + ": where all its branches are known there is no band left.");
    const auto judged = [&](const Eigen::MatrixXd& y) -> Eigen::MatrixXd {
        const Eigen::MatrixXd part = y.middleRows(from, to - from);
        return part.array() - part.mean();
    };
    const auto column = [&](const std::vector<double>& x) -> Eigen::MatrixXd {
        return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Index>(x.size()));
    };
    const auto errorAt = [&](const ParallelHammerstein& model, std::size_t level) {
        InputOutputRecord record;
        record.output = judged(column(blocks.mean(*channel, level)));
        return outputErrorDb({judged(simulate(model, column(blocks.mean(input, level))))}, {record});
    };
    SweepModel result;
    result.level = blocks.plan.levels.back();
    const auto answer = blocks.mean(*channel, levels - 1);
    double least = std::numeric_limits<double>::infinity();
    for (; cut.length >= 128; cut.length /= 2) {
        auto model = identifyHammerstein(loudest, answer, cut).model;
        const double error = errorAt(model, levels - 1);
        if (error < least) {
            least = error;
            result.model = std::move(model);
        }
    }
    for (std::size_t level = 0; level < levels; ++level)
        result.errorDb.push_back(errorAt(result.model, level));
    return result;
}

}  // namespace excursion
