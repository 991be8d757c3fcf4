// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Check/PeriodShift.h"

#include "Engine/Numerics/Median.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Level.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

namespace excursion {
namespace {

using Complex = std::complex<double>;
using Spectrum = std::vector<Complex>;

/// The phase that linear physics cannot promise to repeat to.
constexpr double phaseFloor = 0.001;
constexpr int neighbours = 4;

/// Where the correlation of two periods peaks, to a sample.
double correlationPeak(const Spectrum& cross, const std::vector<int>& lines, int N)
{
    Spectrum onGrid(static_cast<std::size_t>(N / 2 + 1), 0.0);
    for (std::size_t i = 0; i < lines.size(); ++i)
        onGrid[static_cast<std::size_t>(lines[i])] = cross[i];
    const auto correlation = inverseFft(onGrid, static_cast<std::size_t>(N));
    auto peak = std::max_element(correlation.begin(), correlation.end()) - correlation.begin();
    if (2 * peak > N)
        peak -= N;
    return static_cast<double>(peak);
}

/// The shift of cross(k) = Y_{p+1} conj(Y_p) on the excited lines.
/// @param power  |Y_p|^2 on the same lines
PeriodShift shiftOf(const Spectrum& cross, const std::vector<double>& power, const std::vector<int>& lines, int N)
{
    const std::size_t F = lines.size();
    PeriodShift shift;
    // A tie with zero goes to zero: narrow bands have flat peaks.
    shift.samples = correlationPeak(cross, lines, N);
    std::vector<double> phase(F), weight(F);
    double before = 0.0, after = 0.0, swelling = 0.0;
    const auto residualPhases = [&] {
        for (std::size_t i = 0; i < F; ++i)
            phase[i] = std::arg(cross[i] * std::polar(1.0, 2.0 * std::numbers::pi * lines[i] * shift.samples / N));
    };
    // Each round trusts the lines whose phases are coherent so far, and so reaches higher ones.
    for (int round = 0; round < 10; ++round) {
        residualPhases();
        double normal = 0.0, slope = 0.0;
        for (std::size_t i = 0; i < F; ++i) {
            const std::size_t from = i > neighbours ? i - neighbours : 0, to = std::min(F, i + neighbours + 1);
            double square = phaseFloor * phaseFloor;
            for (std::size_t j = from; j < to; ++j)
                square += phase[j] * phase[j] / static_cast<double>(to - from);
            weight[i] = square < 0.3 ? 1.0 / square : 0.0;
            const double x = 2.0 * std::numbers::pi * lines[i] / N;
            normal += weight[i] * x * x;
            slope -= weight[i] * x * phase[i];
        }
        if (normal == 0.0)
            return {0.0, 1e300, 0.0};
        shift.samples += slope / normal;
        shift.standardError = 1.0 / std::sqrt(normal);
    }
    residualPhases();
    for (std::size_t i = 0; i < F; ++i) {
        const double raw = std::arg(cross[i]);
        before += weight[i] * raw * raw;
        after += weight[i] * phase[i] * phase[i];
        if (weight[i] > 0.0 && power[i] > 0.0)
            swelling += weight[i] * std::pow(std::log(std::abs(cross[i]) / power[i]), 2);
    }
    // Noise turns a line as much as it stretches it. A clock only turns; a coil that warms up does both.
    const double stretched = std::max(0.0, swelling - after);
    shift.explained = before > 0.0 ? std::max(0.0, 1.0 - (after + stretched) / (before + stretched)) : 0.0;
    return shift;
}

Spectrum onLines(const Spectrum& spectrum, const std::vector<int>& lines)
{
    Spectrum kept;
    for (const int k : lines)
        kept.push_back(spectrum[static_cast<std::size_t>(k)]);
    return kept;
}

Spectrum crossSpectrum(const Spectrum& earlier, const Spectrum& later)
{
    Spectrum cross(earlier.size());
    for (std::size_t i = 0; i < cross.size(); ++i)
        cross[i] = later[i] * std::conj(earlier[i]);
    return cross;
}

std::vector<double> powerOf(const Spectrum& spectrum)
{
    std::vector<double> power;
    for (const auto& value : spectrum)
        power.push_back(std::norm(value));
    return power;
}

double gainOf(const Spectrum& earlier, const Spectrum& later)
{
    double before = 0.0, after = 0.0;
    for (std::size_t i = 0; i < earlier.size(); ++i) {
        before += std::norm(earlier[i]);
        after += std::norm(later[i]);
    }
    return decibelsOf(after / before);
}

/// The share of a difference that the earlier period explains, where the gain at a line is the mean over its
/// neighbours, 0..1.
double coherenceOf(const Spectrum& earlier, const Spectrum& later)
{
    double explained = 0.0, whole = 0.0;
    const std::size_t F = earlier.size();
    for (std::size_t i = 0; i < F; ++i) {
        const std::size_t from = i > neighbours ? i - neighbours : 0, to = std::min(F, i + neighbours + 1);
        Complex cross = 0.0;
        double power = 0.0;
        for (std::size_t j = from; j < to; ++j)
            if (j != i) {  // a line explains itself
                cross += (later[j] - earlier[j]) * std::conj(earlier[j]);
                power += std::norm(earlier[j]);
            }
        const auto difference = later[i] - earlier[i];
        whole += std::norm(difference);
        if (power > 0.0)
            explained += std::norm(difference) - std::norm(difference - cross / power * earlier[i]);
    }
    return whole > 0.0 ? std::max(0.0, explained / whole) : 0.0;
}

double differenceOf(const Spectrum& earlier, const Spectrum& later)
{
    double difference = 0.0, power = 0.0;
    for (std::size_t i = 0; i < earlier.size(); ++i) {
        difference += std::norm(later[i] - earlier[i]);
        power += std::norm(earlier[i]);
    }
    return power > 0.0 ? difference / power : 0.0;
}

/// PeriodJump::change, between period p and the next. What changes at once does so within a period, so those around it
/// are compared, too.
bool isChange(const std::vector<Spectrum>& spectra, std::size_t p, const std::vector<int>& lines, int N)
{
    const double pair = differenceOf(spectra[p], spectra[p + 1]);
    for (const std::size_t from : {p, std::max<std::size_t>(p, 1) - 1})
        for (const std::size_t to : {p + 1, std::min(p + 2, spectra.size() - 1)}) {
            const auto &earlier = spectra[from], &later = spectra[to];
            if (!(differenceOf(earlier, later) > 0.3 * pair && coherenceOf(earlier, later) > changedFrom))
                continue;
            const auto shift = shiftOf(crossSpectrum(earlier, later), powerOf(earlier), lines, N);
            const bool lost = shift.explained > 0.6 && std::abs(shift.samples) > 0.5;  // samples are lost whole
            if (!lost)
                return true;
        }
    return false;
}

/// A used period, cut a quarter earlier when there is a settling period: a channel that is early, or drifts, would
/// else have a piece of the next realization in its last period.
std::span<const double> earlyPeriod(const Measurement& take, const Channel& channel, int level, int realization,
                                    int period)
{
    const auto inTime = onePeriod(take, channel, level, realization, period);
    const std::ptrdiff_t lead = take.excitation->settlePeriods > 0 ? take.excitation->period / 4 : 0;
    return {inTime.data() - lead, inTime.size()};
}

std::vector<Spectrum> earlySpectra(const Measurement& take, const Channel& channel, int level, int realization,
                                   const std::vector<int>& lines)
{
    std::vector<Spectrum> spectra;
    for (int p = 0; p < take.excitation->periods; ++p)
        spectra.push_back(onLines(fft(earlyPeriod(take, channel, level, realization, p)), lines));
    return spectra;
}

/// Of a used period, where it stands.
Spectrum spectrumOf(const Measurement& take, const Channel& channel, int level, int realization, int period,
                    const std::vector<int>& lines)
{
    return onLines(fft(onePeriod(take, channel, level, realization, period)), lines);
}

/// Power of the difference of two periods over the power of the first, but for their ends.
double relativeDifference(std::span<const double> earlier, std::span<const double> later)
{
    const std::size_t end = std::min<std::size_t>(256, earlier.size() / 8);
    const auto inner = earlier.subspan(end, earlier.size() - 2 * end);
    double mean = 0.0, difference = 0.0, power = 0.0;
    for (const double value : inner)
        mean += value / static_cast<double>(inner.size());
    for (std::size_t n = 0; n < inner.size(); ++n) {
        difference += (later[n + end] - inner[n]) * (later[n + end] - inner[n]);
        power += (inner[n] - mean) * (inner[n] - mean);
    }
    return power > 0.0 ? difference / power : 0.0;
}

/// The median of the differences that the other realizations have between the same two periods: a motion that has not
/// settled makes those of the first pair large in most of them. Of two realizations the other one tells only of the
/// first pair, as it may have been knocked itself. 0 where nothing tells.
double atSamePeriod(const std::vector<PeriodJump>& pairs, const std::vector<double>& differences, std::size_t own)
{
    std::vector<double> others;
    for (std::size_t i = 0; i < pairs.size(); ++i)
        if (i != own && pairs[i].period == pairs[own].period)
            others.push_back(differences[i]);
    return others.empty() || (others.size() == 1 && pairs[own].period > 0) ? 0.0 : medianOf(others);
}

/// PeriodJump::moved: what the best two steps among blocks of the difference span.
double restMoved(std::span<const double> earlier, std::span<const double> later)
{
    constexpr std::size_t blocks = 64;
    constexpr int pieces = 3;
    constexpr double most = 0.5, much = 0.25;  // at its new rest the cone swings in
    constexpr double plateaus = 0.96;
    const std::size_t length = earlier.size() / blocks;
    if (length == 0)
        return 0.0;
    double whole = 0.0;
    std::array<double, blocks + 1> sum {};  // of the difference, up to a block
    for (std::size_t b = 0; b < blocks; ++b) {
        sum[b + 1] = sum[b];
        for (std::size_t n = b * length; n < (b + 1) * length; ++n) {
            const double difference = later[n] - earlier[n];
            sum[b + 1] += difference;
            whole += difference * difference;
        }
    }
    const auto mean = [&](std::size_t from, std::size_t to) {
        return (sum[to] - sum[from]) / static_cast<double>(length * (to - from));
    };
    struct Best {
        double explained = -1.0;
        std::size_t from = 0;
    };
    std::array<std::array<Best, blocks + 1>, pieces + 1> best {};
    best[0][0].explained = 0.0;
    for (int piece = 1; piece <= pieces; ++piece)
        for (std::size_t to = 1; to <= blocks; ++to)
            for (std::size_t from = 0; from < to; ++from)
                if (const double before = best[piece - 1][from].explained; before >= 0.0) {
                    const double here = mean(from, to),
                                 all = before + here * here * static_cast<double>(length * (to - from));
                    if (all > best[piece][to].explained)
                        best[piece][to] = {all, from};
                }
    // A rest that drifts makes the difference constant: what steps is asked for beside the mean.
    const double constant = sum[blocks] * mean(0, blocks);
    const double explained = (best[pieces][blocks].explained - constant) / (whole - constant);
    if (!(explained > most))
        return 0.0;
    // What jumps does so from one block to the next, or within one; what drifts faster and faster takes its time. A
    // motion that settles comes back, and takes its time for that. Where periods are short, a leap takes some blocks,
    // too: of one that takes a quarter of the period, amid it, three pieces explain 0.98, of a ramp or of what decays
    // 0.95 at most.
    int jumps = 0;
    const double last = mean(best[pieces][blocks].from, blocks);
    double first = last, least = last, largest = last;
    std::size_t to = best[pieces][blocks].from, end = blocks;
    for (int piece = pieces - 1; piece > 0; --piece) {
        const auto from = best[piece][to].from;
        first = mean(from, to);
        jumps += (mean(to, to + 1) - mean(to - 1, to)) / (mean(to, end) - first) > 0.5;
        least = std::min(least, first);
        largest = std::max(largest, first);
        end = to;
        to = from;
    }
    const double moved = largest - least;
    const bool stays = explained > plateaus || jumps == pieces - 1
                       || (jumps > 0 && std::abs(last - first) > 0.5 * moved);
    return stays && moved * moved * static_cast<double>(length * blocks) > much * whole ? moved : 0.0;
}

}  // namespace

std::optional<PeriodShift> periodShift(const AveragedPeriods& averages, const Channel& channel, int level)
{
    const auto& take = averages.take();
    const Excitation& e = averages.excitation();
    const auto& lines = averages.lines();
    if (e.periods < 2)
        return std::nullopt;
    Spectrum sum(lines.size(), 0.0);
    std::vector<double> power(lines.size(), 0.0);
    std::vector<PeriodShift> pairs;
    for (int m = 0; m < e.realizations; ++m) {
        const auto spectra = earlySpectra(take, channel, level, m, lines);
        for (std::size_t p = 0; p + 1 < spectra.size(); ++p) {
            const auto cross = crossSpectrum(spectra[p], spectra[p + 1]);
            const auto own = powerOf(spectra[p]);
            pairs.push_back(shiftOf(cross, own, lines, e.period));
            for (std::size_t i = 0; i < sum.size(); ++i) {
                sum[i] += cross[i];
                power[i] += own[i];
            }
        }
    }
    auto shift = shiftOf(sum, power, lines, e.period);
    constexpr double sure = 6.0, share = 0.3, most = 0.6;
    const auto alike = std::count_if(pairs.begin(), pairs.end(), [&shift](const PeriodShift& pair) {
        return std::abs(pair.samples - shift.samples) < sure * pair.standardError + share * std::abs(shift.samples);
    });
    shift.steady = static_cast<double>(alike) >= most * static_cast<double>(pairs.size());
    return shift;
}

std::vector<PeriodJump> periodJumps(const AveragedPeriods& averages, const Channel& channel)
{
    const auto& take = averages.take();
    const Excitation& e = averages.excitation();
    const auto& lines = averages.lines();
    std::vector<PeriodJump> jumps;
    for (int level = 0; level < static_cast<int>(e.levels.size()); ++level) {
        std::vector<PeriodJump> pairs;
        std::vector<double> differences;
        for (int m = 0; m < e.realizations; ++m)
            for (int p = 0; p + 1 < e.periods; ++p) {
                differences.push_back(relativeDifference(earlyPeriod(take, channel, level, m, p),
                                                         earlyPeriod(take, channel, level, m, p + 1)));
                pairs.push_back({level, m, p, 10.0 * std::log10(differences.back() + 1e-300), false, 0.0, 0.0});
            }
        if (pairs.size() < 3)
            continue;
        // Most pairs are sound; thousands of lines make their differences equal within a few percent.
        constexpr double clearly = 30.0;
        const double typical = medianOf(differences);
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            if (!(differences[i] > 1e-4))
                continue;
            // Rests that jump may do so in most pairs.
            const double moved = channel.quantity == Quantity::displacement ? restMoved(
                                     earlyPeriod(take, channel, level, pairs[i].realization, pairs[i].period),
                                     earlyPeriod(take, channel, level, pairs[i].realization, pairs[i].period + 1))
                                                                            : 0.0;
            const double apart = clearly * std::max(typical, atSamePeriod(pairs, differences, i));
            if (!(differences[i] > apart || moved != 0.0))
                continue;
            auto& jump = jumps.emplace_back(pairs[i]);
            jump.moved = moved;
            const auto spectra = earlySpectra(take, channel, level, jump.realization, lines);
            const auto p = static_cast<std::size_t>(jump.period);
            jump.change = isChange(spectra, p, lines, e.period);
            // until the end, or only for that pair, whichever is more
            jump.gainDb = gainOf(spectra[std::max<std::size_t>(p, 1) - 1],
                                 spectrumOf(take, channel, level, jump.realization, e.periods - 1, lines));
            if (const double there = gainOf(spectra[p], spectra[p + 1]); std::abs(there) > std::abs(jump.gainDb))
                jump.gainDb = there;
        }
    }
    return jumps;
}

double changedShare(const AveragedPeriods& averages, const Channel& channel, int level)
{
    const auto& take = averages.take();
    const Excitation& e = averages.excitation();
    const auto& lines = averages.lines();
    double sum = 0.0;
    for (int m = 0; m < e.realizations; ++m)
        sum += coherenceOf(spectrumOf(take, channel, level, m, 0, lines),
                           spectrumOf(take, channel, level, m, e.periods - 1, lines));
    return sum / e.realizations;
}

}  // namespace excursion
