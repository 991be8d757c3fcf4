// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/InputDeparture.h"

#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>

namespace excursion {

InputDeparture inputDeparture(const AveragedPeriods& averages, int level, int realization,
                              const std::vector<double>& driven, const std::vector<double>& variance, double highest,
                              std::size_t samples)
{
    constexpr double worthIt = 4.0, least = 1e-10;  // times the noise; of the input's power
    const auto& take = averages.take();
    const auto& e = averages.excitation();
    InputDeparture departure {e.settlePeriods, e.periods, {}};
    const auto period = static_cast<std::size_t>(e.period),
               played = static_cast<std::size_t>(e.settlePeriods + e.periods),
               begin = static_cast<std::size_t>(level * e.realizations + realization) * played * period;
    std::vector<double> d(static_cast<std::size_t>(departure.windows()) * period, 0.0);
    for (std::size_t n = 0; n < played * period; ++n)
        d[n] = take.input().samples[begin + n] - driven[n % period];
    auto spectrum = fft(d);
    const auto lines = static_cast<std::size_t>(highest / take.sampleRate * static_cast<double>(d.size()));
    spectrum.resize(std::min(spectrum.size(), lines + 1));

    // What a driver has forgotten by then does not count: a crossfade in the first half of the settling.
    const auto from = static_cast<std::size_t>(e.settlePeriods) * period - (e.settlePeriods > 0 ? period / 2 : 0);
    std::fill(d.begin(), d.begin() + static_cast<std::ptrdiff_t>(from), 0.0);
    const auto heard = fft(d);
    double power = 0.0, noise = 0.0, input = 0.0;
    for (std::size_t l = 0; l < spectrum.size(); ++l)
        power += std::norm(heard[l]);
    const auto once = fft(driven);
    for (std::size_t k = 1; k < once.size() && k * static_cast<std::size_t>(departure.windows()) <= lines; ++k) {
        input += std::norm(once[k]);
        noise += variance.empty() ? 0.0 : e.periods * variance[k];  // of one period; that of the mean is less
    }
    const double periodsHeard = static_cast<double>(played * period - from) / static_cast<double>(period);
    if (power < departure.windows() * periodsHeard * std::max(worthIt * noise, least * input))
        return departure;
    const double scale = static_cast<double>(samples) / static_cast<double>(period);
    for (auto& line : spectrum)
        line *= scale;
    departure.spectrum = std::move(spectrum);
    return departure;
}

}  // namespace excursion
