// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/InputDeparture.h"

#include "Engine/Numerics/Median.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion {
namespace {

/// Rises from 0 to 1 as `at` goes from 0 to 1.
double rise(double at)
{
    const double within = std::clamp(at, 0.0, 1.0);
    return 0.5 - 0.5 * std::cos(std::numbers::pi * within);
}

/// Takes out what is no more than noise: Wiener's filter on means over neighbouring lines.
/// @param noise  E|.|^2 of a line
void silence(std::vector<std::complex<double>>& spectrum, const std::vector<double>& noise)
{
    constexpr std::size_t around = 8;
    std::vector<double> power(spectrum.size() + 1, 0.0);
    for (std::size_t l = 0; l < spectrum.size(); ++l)
        power[l + 1] = power[l] + std::norm(spectrum[l]);
    for (std::size_t l = 0; l < spectrum.size(); ++l) {
        const std::size_t first = l - std::min(l, around), end = std::min(spectrum.size(), l + around + 1);
        const double mean = (power[end] - power[first]) / static_cast<double>(end - first);
        spectrum[l] *= mean > 0.0 ? std::max(0.0, 1.0 - noise[l] / mean) : 0.0;
    }
}

}  // namespace

InputDeparture inputDeparture(const AveragedPeriods& averages, int level, int realization,
                              const std::vector<double>& driven, const std::vector<double>& variance, double highest,
                              std::size_t samples)
{
    constexpr double worthIt = 4.0, least = 1e-10;  // times the noise; of the input's power
    constexpr std::size_t mostLines = 2048;
    const auto& take = averages.take();
    const auto& e = averages.excitation();
    InputDeparture departure {e.settlePeriods, e.periods, {}};
    const auto period = static_cast<std::size_t>(e.period),
               settled = static_cast<std::size_t>(e.settlePeriods) * period,
               played = settled + static_cast<std::size_t>(e.periods) * period,
               begin = static_cast<std::size_t>(level * e.realizations + realization) * played;
    std::vector<double> d(static_cast<std::size_t>(departure.windows()) * period, 0.0);
    // What a driver has forgotten by then does not count: a crossfade in the first half of the last settling period.
    const double N = static_cast<double>(period), middle = static_cast<double>(settled) - 0.5 * N;
    for (std::size_t n = 0; n < played; ++n)
        d[n] = (settled > 0 ? rise(0.5 + (static_cast<double>(n) - middle) / (0.5 * N)) : 1.0)
               * (take.input().samples[begin + n] - driven[n % period]);
    auto spectrum = fft(d);
    const double resolution = take.sampleRate / static_cast<double>(d.size());
    spectrum.resize(std::min({spectrum.size(), mostLines, static_cast<std::size_t>(highest / resolution) + 1}));

    const double heard = static_cast<double>(played) - std::max(0.0, middle);
    std::vector<double> noise(spectrum.size(), 0.0);
    double power = 0.0, sum = 0.0, input = 0.0;
    // At low lines the scatter of the periods is what departs.
    const double usual = variance.empty() ? 0.0 : medianOf(variance);
    const auto once = fft(driven);
    for (std::size_t l = 0; l < spectrum.size(); ++l) {
        const std::size_t k = std::min(l / static_cast<std::size_t>(departure.windows()), once.size() - 1);
        power += std::norm(spectrum[l]);
        input += std::norm(once[k]) * heard / N;
        if (!variance.empty())  // of the mean; one period has that many times as much
            sum += noise[l] = e.periods * std::min(variance[k], usual) * heard / N;
    }
    if (power < std::max(worthIt * sum, least * input))
        return departure;
    silence(spectrum, noise);
    const double scale = static_cast<double>(samples) / N, lines = static_cast<double>(spectrum.size());
    for (std::size_t l = 0; l < spectrum.size(); ++l)  // a sharp end would ring through all periods
        spectrum[l] *= scale * rise(2.0 * (1.0 - static_cast<double>(l) / lines));
    departure.spectrum = std::move(spectrum);
    return departure;
}

}  // namespace excursion
