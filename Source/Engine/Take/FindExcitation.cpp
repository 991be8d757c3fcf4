// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Take/FindExcitation.h"

#include "Engine/Error.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {
namespace {

constexpr double excitedOverNoise = 10.0;    // 10 dB
constexpr double excitedBelowShape = 0.025;  // -16 dB
constexpr std::size_t noiseNeighbours = 12;  // lines to either side
// `difference` of the same period in noise; other phases or levels differ by more
constexpr double steady = 0.02;

/// Powers of the lines of a period: of the average, and of its noise.
struct LinePowers {
    std::vector<double> power, noise;
};

double energy(std::span<const double> x)
{
    double sum = 0.0;
    for (const double v : x)
        sum += v * v;
    return sum;
}

LinePowers linePowers(std::span<const double> input, const Excitation& e)
{
    const auto N = static_cast<std::size_t>(e.period), P = static_cast<std::size_t>(e.periods);
    LinePowers lines {std::vector<double>(N / 2 + 1), std::vector<double>(N / 2 + 1)};
    const auto block = static_cast<std::size_t>(e.samplesPerRealization());
    const std::size_t blocks = static_cast<std::size_t>(e.totalSamples()) / block;
    for (std::size_t b = 0; b < blocks; ++b) {
        const auto used = input.subspan(b * block + N * static_cast<std::size_t>(e.settlePeriods), N * P);
        const double scale = energy(used) / static_cast<double>(P);  // all levels count alike
        if (!(scale > 0))
            continue;
        std::vector<std::complex<double>> sum(N / 2 + 1);
        std::vector<double> squares(N / 2 + 1);
        for (std::size_t p = 0; p < P; ++p) {
            const auto U = fft(used.subspan(p * N, N));
            for (std::size_t k = 0; k < U.size(); ++k) {
                sum[k] += U[k];
                squares[k] += std::norm(U[k]);
            }
        }
        const auto count = static_cast<double>(P);
        for (std::size_t k = 0; k < sum.size(); ++k) {
            const double average = std::norm(sum[k]) / (count * count);
            lines.power[k] += average / scale;
            if (P > 1)  // variance of the average
                lines.noise[k] += std::max(0.0, squares[k] / count - average) / (count - 1) / scale;
        }
    }
    return lines;
}

/// The noise is smooth, its estimate from a few periods is not: the mean over neighbouring lines.
std::vector<double> smoothed(const std::vector<double>& noise)
{
    std::vector<double> sums(noise.size() + 1), result(noise.size());
    for (std::size_t k = 0; k < noise.size(); ++k)
        sums[k + 1] = sums[k] + noise[k];
    for (std::size_t k = 0; k < noise.size(); ++k) {
        const auto first = k > noiseNeighbours ? k - noiseNeighbours : 0;
        const auto end = std::min(noise.size(), k + noiseNeighbours + 1);
        result[k] = std::max((sums[end] - sums[first]) / static_cast<double>(end - first), noise[k] / 4);
    }
    return result;
}

double rms(std::span<const double> x) { return std::sqrt(energy(x) / static_cast<double>(x.size())); }

/// How far two stretches of equal length differ: energy of the difference over their mean energy.
double difference(std::span<const double> a, std::span<const double> b)
{
    double sum = 0.0;
    for (std::size_t n = 0; n < a.size(); ++n)
        sum += (a[n] - b[n]) * (a[n] - b[n]);
    const double size = (energy(a) + energy(b)) / 2;
    return size > 0 ? sum / size : 0.0;
}

/// The differences between the pieces of a record and what comes `lag` samples later, ascending; silence left out.
std::vector<double> differencesAfter(std::span<const double> input, std::size_t lag)
{
    const std::size_t piece = std::max<std::size_t>(8, lag / 4);
    const double silence = 1e-8 * energy(input) * static_cast<double>(piece) / static_cast<double>(input.size());
    std::vector<double> differences;
    for (std::size_t n = 0; n + lag + piece <= input.size(); n += piece) {
        const auto a = input.subspan(n, piece), b = input.subspan(n + lag, piece);
        if (energy(a) + energy(b) > silence)
            differences.push_back(difference(a, b));
    }
    std::sort(differences.begin(), differences.end());
    return differences;
}

double repeatingShare(std::span<const double> input, std::size_t lag)
{
    const auto differences = differencesAfter(input, lag);
    const auto same = std::lower_bound(differences.begin(), differences.end(), steady) - differences.begin();
    return differences.empty() ? 0.0 : static_cast<double>(same) / static_cast<double>(differences.size());
}

/// The peak of a correlation may be a few samples off where a few low lines hold most of the power. The
/// steps from sample to sample are whiter, so they repeat at no other lag; what repeats best, the loud
/// and settled part, decides.
std::size_t sharpened(std::span<const double> input, std::size_t lag)
{
    constexpr std::size_t around = 8;
    std::vector<double> steps(input.size() - 1);
    for (std::size_t n = 0; n < steps.size(); ++n)
        steps[n] = input[n + 1] - input[n];
    std::size_t best = lag;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t other = lag - around; other <= lag + around; ++other) {
        const auto differences = differencesAfter(steps, other);
        if (!differences.empty() && differences[differences.size() / 10] < least) {
            best = other;
            least = differences[differences.size() / 10];
        }
    }
    return best;
}

/// Realizations as they show in the record: each a run of periods, the first ones still settling.
struct Runs {
    std::size_t length = 0;    ///< periods of each; 0 where they are not all equal, or never settle
    std::size_t settling = 0;  ///< most periods before one that is as the next
};

Runs equalRuns(std::span<const double> input, std::size_t N)
{
    const std::size_t periods = input.size() / N;
    std::vector<bool> asBefore(periods, false);
    for (std::size_t p = 1; p < periods; ++p)
        asBefore[p] = difference(input.subspan(p * N, N), input.subspan((p - 1) * N, N)) < steady;
    // A realization begins where what had settled changes.
    std::vector<std::size_t> starts {0};
    for (std::size_t p = 1; p < periods; ++p)
        if (!asBefore[p] && asBefore[p - 1])
            starts.push_back(p);
    starts.push_back(periods);
    Runs runs {starts[1], 0};
    for (std::size_t r = 1; r < starts.size(); ++r) {
        std::size_t settled = starts[r - 1] + 1;
        while (settled < starts[r] && !asBefore[settled])
            ++settled;
        if (starts[r] - starts[r - 1] != runs.length || settled == starts[r])
            return {};
        runs.settling = std::max(runs.settling, settled - starts[r - 1] - 1);
    }
    return runs;
}

/// The levels of realizations that go from quiet to loud, each the same number of times; empty when they do not.
std::vector<double> ascendingLevels(const std::vector<double>& rmsOfRun)
{
    constexpr double sameLevel = 0.03;
    std::vector<double> levels;
    std::vector<std::size_t> counts;
    for (const double value : rmsOfRun)
        if (!levels.empty() && std::abs(value - levels.back()) <= sameLevel * levels.back()) {
            ++counts.back();
        } else {
            levels.push_back(value);
            counts.push_back(1);
        }
    const bool even = std::all_of(counts.begin(), counts.end(),
                                  [&](std::size_t count) { return count == counts.front(); });
    return even && std::is_sorted(levels.begin(), levels.end()) && levels.front() > 0 ? levels : std::vector<double> {};
}

}  // namespace

std::vector<int> findLines(std::span<const double> input, const Excitation& e)
{
    if (e.period < 4 || e.periods < 1 || e.totalSamples() <= 0 || e.totalSamples() > static_cast<long>(input.size()))
        throw Error(Error::Kind::data,
                    "The excited lines cannot be found: the record is shorter than its excitation says.");
    const auto powers = linePowers(input, e);
    const auto &power = powers.power, noise = smoothed(powers.noise);
    const auto last = static_cast<std::size_t>((e.period - 1) / 2);
    const auto stands = [&](std::size_t k) { return power[k] > excitedOverNoise * noise[k]; };

    // The least power an excited line can have, from the lines below (falling as red) and above (flat).
    std::vector<double> least(last + 2);
    double red = 0.0;
    for (std::size_t k = 1; k <= last; ++k) {
        const auto square = static_cast<double>(k) * static_cast<double>(k);
        if (stands(k))
            red = std::max(red, power[k] * square);
        least[k] = red / square;
    }
    double flat = 0.0;
    for (std::size_t k = last; k >= 1; --k) {
        if (stands(k))
            flat = std::max(flat, power[k]);
        least[k] = std::max(least[k], flat);
    }
    std::vector<int> lines;
    for (std::size_t k = 1; k <= last; ++k)
        if (stands(k) && power[k] > excitedBelowShape * least[k])
            lines.push_back(static_cast<int>(k));
    return lines;
}

int findPeriod(std::span<const double> input)
{
    constexpr std::size_t shortest = 16;
    const std::size_t L = input.size();
    if (L < 4 * shortest || L > (1u << 30))
        return 0;
    std::vector<double> padded(2 * L);
    std::copy(input.begin(), input.end(), padded.begin());
    auto spectrum = fft(padded);
    for (auto& value : spectrum)
        value = std::norm(value);
    const auto correlation = inverseFft(spectrum, padded.size());
    std::vector<double> head(L + 1);  // energy of the first n samples
    for (std::size_t n = 0; n < L; ++n)
        head[n + 1] = head[n] + input[n] * input[n];
    const auto similarity = [&](std::size_t lag) {
        const double both = head[L - lag] * (head[L] - head[lag]);
        return both > 0 ? correlation[lag] / std::sqrt(both) : 0.0;
    };

    // A third of a record or more repeats after a period (settling, used, used); the whole of it may after several (the
    // same phases at the next level), so that the highest peak is not always the one.
    constexpr double share = 0.3;
    constexpr std::size_t mostCandidates = 200;
    std::size_t first = 1;
    while (first <= L / 2 && similarity(first) > 0)  // out of the main lobe
        ++first;
    std::vector<std::pair<double, std::size_t>> candidates;
    for (std::size_t lag = std::max(first, shortest); lag <= L / 2; ++lag)
        if (const double r = similarity(lag); r > share && r >= similarity(lag - 1) && r >= similarity(lag + 1))
            candidates.emplace_back(r, lag);
    std::sort(candidates.rbegin(), candidates.rend());
    candidates.resize(std::min(candidates.size(), mostCandidates));
    std::sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    const auto found = std::find_if(candidates.begin(), candidates.end(),
                                    [&](const auto& c) { return repeatingShare(input, c.second) > share; });
    return found == candidates.end() ? 0 : static_cast<int>(sharpened(input, found->second));
}

std::optional<Excitation> findExcitation(std::span<const double> input, double sampleRate)
{
    Excitation e;
    e.period = findPeriod(input);
    if (e.period == 0)
        return std::nullopt;
    const auto N = static_cast<std::size_t>(e.period);
    const auto [run, settling] = equalRuns(input, N);
    const std::size_t runs = run > 0 ? input.size() / N / run : 0;
    std::vector<double> rmsOfRun;
    for (std::size_t r = 0; r < runs; ++r)
        rmsOfRun.push_back(rms(input.subspan(((r + 1) * run - 1) * N, N)));
    if (rmsOfRun.empty())
        return std::nullopt;
    e.levels = ascendingLevels(rmsOfRun);
    if (e.levels.empty())
        return std::nullopt;
    e.settlePeriods = static_cast<int>(run >= 3 ? std::max<std::size_t>(1, settling) : 0);
    e.periods = static_cast<int>(run) - e.settlePeriods;
    e.realizations = static_cast<int>(runs / e.levels.size());
    e.lines = findLines(input, e);
    if (e.lines.empty())
        return std::nullopt;
    e.bandLow = e.lines.front() * sampleRate / e.period;
    e.bandHigh = e.lines.back() * sampleRate / e.period;
    return e;
}

void completeExcitation(Measurement& measurement)
{
    const auto& input = measurement.input().samples;
    if (!measurement.excitation)
        measurement.excitation = findExcitation(input, measurement.sampleRate);
    else if (measurement.excitation->lines.empty())
        measurement.excitation->lines = findLines(input, *measurement.excitation);
}

}  // namespace excursion
