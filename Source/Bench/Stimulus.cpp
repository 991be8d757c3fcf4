// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Stimulus.h"

#include "Engine/Error.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion::bench {
namespace {

constexpr long hold = 256, fade = 1024;

// From 0 to 1 as n goes from 0 to `fade`; the ends are met within 1e-16.
double fadeIn(long n) { return 0.5 * std::erfc(-6.0 * (2.0 * static_cast<double>(n) / fade - 1.0)); }

}  // namespace

std::vector<int> excitedLines(const Excitation& plan, double sampleRate, Random& random)
{
    const double resolution = sampleRate / plan.period;
    const int first = std::max(1, static_cast<int>(std::ceil(plan.bandLow / resolution - 1e-9)));
    const int last = std::min((plan.period - 1) / 2, static_cast<int>(std::floor(plan.bandHigh / resolution + 1e-9)));
    std::vector<int> lines;
    if (plan.grid == "full") {
        for (int k = first; k <= last; ++k)
            lines.push_back(k);
        return lines;
    }
    for (int k = first | 1; k <= last; k += 2)
        lines.push_back(k);
    if (plan.grid == "odd")
        return lines;
    if (plan.grid != "odd-random")
        throw Error(Error::Kind::usage,
                    "The virtual bench plays the grids full, odd and odd-random, not \"" + plan.grid + "\".");
    std::vector<int> kept;
    for (std::size_t group = 0; group < lines.size(); group += detectionGroup) {
        const auto end = std::min(lines.size(), group + detectionGroup);
        const auto silent = group + static_cast<std::size_t>(random.index(detectionGroup));
        for (auto n = group; n < end; ++n)
            if (n != silent)
                kept.push_back(lines[n]);
    }
    return kept;
}

std::vector<double> multisine(const Excitation& plan, const std::vector<int>& lines, Random& random)
{
    const double power = plan.shape == "red" ? 1.0 : plan.shape == "pink" ? 0.5 : 0.0;
    const auto N = static_cast<std::size_t>(plan.period);
    std::vector<std::complex<double>> spectrum(N / 2 + 1);
    double square = 0.0;
    for (const int k : lines) {
        const double amplitude = std::pow(static_cast<double>(k), -power);
        square += 0.5 * amplitude * amplitude;
        spectrum[static_cast<std::size_t>(k)] = std::polar(amplitude, 2.0 * std::numbers::pi * random.uniform());
    }
    for (auto& value : spectrum)
        value *= 0.5 * static_cast<double>(N) / std::sqrt(square);
    return inverseFft(spectrum, N);
}

std::vector<double> drive(const Excitation& plan, double sampleRate, std::uint64_t seed, int tail, bool jumps)
{
    Random gridChoice(seed, 1);
    const auto lines = plan.lines.empty() ? excitedLines(plan, sampleRate, gridChoice) : plan.lines;
    if (lines.empty())
        throw Error(Error::Kind::usage,
                    "No line of the multisine falls into the band; widen it or lengthen the period.");
    std::vector<std::vector<double>> waves;
    for (int r = 0; r < plan.realizations; ++r) {
        Random phases(seed, 100 + static_cast<std::uint64_t>(r));
        waves.push_back(multisine(plan, lines, phases));
    }

    const long period = plan.period, part = plan.samplesPerRealization();
    std::vector<double> out;
    out.reserve(static_cast<std::size_t>(plan.totalSamples() + tail));
    const std::vector<double>* before = nullptr;
    double gainBefore = 0.0;
    for (const double level : plan.levels)
        for (const auto& wave : waves) {
            for (long n = 0; n < part; ++n) {
                const auto at = static_cast<std::size_t>(n % period);
                double value = level * wave[at];
                if (n < hold + fade && (!jumps || !before)) {
                    const double weight = n < hold ? 0.0 : fadeIn(n - hold);
                    value = weight * value + (before ? (1.0 - weight) * gainBefore * (*before)[at] : 0.0);
                }
                out.push_back(value);
            }
            before = &wave;
            gainBefore = level;
        }
    for (long n = 0; n < tail && before; ++n) {
        const double weight = n < hold ? 1.0 : n < hold + fade ? 1.0 - fadeIn(n - hold) : 0.0;
        out.push_back(weight * gainBefore * (*before)[static_cast<std::size_t>(n % period)]);
    }
    return out;
}

}  // namespace excursion::bench
