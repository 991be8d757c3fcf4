// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/LineNoise.h"

#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace excursion {
namespace {

using Spectrum = std::vector<std::complex<double>>;

/// Sums over lines of one kind, to be asked between any two.
struct Tally {
    std::vector<double> total, count;

    Tally(const std::vector<double>& raw, const std::vector<char>& played, char kind)
        : total(raw.size() + 1, 0.0), count(raw.size() + 1, 0.0)
    {
        for (std::size_t k = 0; k < raw.size(); ++k) {
            total[k + 1] = total[k] + (played[k] == kind ? raw[k] : 0.0);
            count[k + 1] = count[k] + (played[k] == kind ? 1.0 : 0.0);
        }
    }
    /// The mean from k - reach to k + reach, without line 0 (an offset that drifts); nothing of fewer than `enough`
    /// lines.
    std::optional<double> around(std::size_t k, std::size_t reach, double enough) const
    {
        const std::size_t from = k > reach ? k - reach : 1, to = std::min(count.size() - 1, k + reach + 1);
        const double lines = count[to] - count[from];
        return lines < enough ? std::nullopt : std::optional((total[to] - total[from]) / lines);
    }
};

std::vector<char> marked(const std::vector<int>& lines, std::size_t count)
{
    std::vector<char> played(count, 0);
    for (const int k : lines)
        if (static_cast<std::size_t>(k) < count)
            played[static_cast<std::size_t>(k)] = 1;
    return played;
}

std::size_t reachAt(std::size_t line) { return std::max<std::size_t>(12, line / 16); }

}  // namespace

double powerOf(const Spectrum& spectrum)
{
    double sum = 0.0;
    for (std::size_t k = 1; k < spectrum.size(); ++k)
        sum += std::norm(spectrum[k]);
    return sum;
}

std::vector<double> smoothVariance(const std::vector<double>& raw, const std::vector<int>& excited)
{
    constexpr double enough = 12.0;  // lines that share
    const auto played = marked(excited, raw.size());
    const Tally silentOnes(raw, played, 0), playedOnes(raw, played, 1);
    auto result = raw;
    for (std::size_t k = 1; k < raw.size(); ++k) {
        auto reach = reachAt(k);
        const auto& alike = played[k] ? playedOnes : silentOnes;
        std::optional<double> mean;
        for (; !mean; reach *= 2)  // on a sparse grid as far as it takes to find enough of them
            mean = alike.around(k, reach, reach < raw.size() ? enough : 1.0);
        result[k] = std::max(*mean, raw[k] / 6.0);
    }
    return result;
}

std::vector<double> withoutDrift(std::vector<double> smooth, const std::vector<double>& raw,
                                 const std::vector<int>& excited,
                                 const std::function<std::vector<double>()>& besideDrift)
{
    constexpr double enough = 6.0;
    const auto played = marked(excited, raw.size());
    const Tally silentOnes(raw, played, 0);
    std::vector<double> beside;
    for (std::size_t k = 0; k < raw.size(); ++k) {
        if (!played[k])
            continue;
        const auto silent = silentOnes.around(k, reachAt(k), enough);
        if (!silent && beside.empty())
            beside = besideDrift();
        smooth[k] = std::min(smooth[k], silent ? *silent : beside[k]);
    }
    return smooth;
}

std::vector<double> evenDeviation(std::size_t lines, double power)
{
    constexpr double nominal = 1e-3;
    return std::vector<double>(lines, std::max(nominal * std::sqrt(power / static_cast<double>(lines)), 1e-300));
}

std::vector<double> deviations(const Spectrum& measured, const std::vector<double>& variance, double relativeFloor)
{
    const double perLine = powerOf(measured) / static_cast<double>(measured.size());
    auto result = evenDeviation(measured.size(), powerOf(measured));
    if (!variance.empty())
        for (std::size_t k = 0; k < result.size(); ++k)
            result[k] = std::sqrt(variance[k] + perLine * relativeFloor * relativeFloor);
    for (auto& deviation : result)
        deviation = std::max(deviation, 1e-300);
    return result;
}

void silenceNoise(std::vector<double>& period, const std::vector<double>& variance, const std::vector<int>& excited)
{
    constexpr double standsOut = 16.0;  // times the noise power
    auto spectrum = fft(period);
    const auto before = spectrum;
    for (std::size_t k = 0; k < spectrum.size(); ++k)
        if (std::norm(spectrum[k]) < standsOut * variance[k])
            spectrum[k] = 0.0;
    for (const int k : excited)
        spectrum[static_cast<std::size_t>(k)] = before[static_cast<std::size_t>(k)];
    period = inverseFft(spectrum, period.size());
}

}  // namespace excursion
