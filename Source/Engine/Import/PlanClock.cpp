// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/PlanClock.h"

#include "Engine/Error.h"
#include "Engine/Import/PlanPeriods.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Resample.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion {
namespace {

/// samples of the plan before and after it that are read, too; the outer half fades
constexpr double margin = 4096.0;

/// x[first], x[first + 1], ...; silent outside; both ends faded over `fade` samples.
std::vector<double> stretch(std::span<const double> x, std::ptrdiff_t first, std::size_t count, std::size_t fade)
{
    std::vector<double> part(count, 0.0);
    const auto size = static_cast<std::ptrdiff_t>(x.size());
    const auto begin = std::clamp<std::ptrdiff_t>(first, 0, size),
               end = std::clamp<std::ptrdiff_t>(first + static_cast<std::ptrdiff_t>(count), 0, size);
    if (begin < end)
        std::copy(x.begin() + begin, x.begin() + end, part.begin() + (begin - first));
    fade = std::min(fade, count / 2);
    for (std::size_t n = 0; n < fade; ++n) {
        const double weight =
            0.5 - 0.5 * std::cos(std::numbers::pi * (static_cast<double>(n) + 0.5) / static_cast<double>(fade));
        part[n] *= weight;
        part[count - 1 - n] *= weight;
    }
    return part;
}

/// The periodic record through x at `factor` times its rate, by zeros in its spectrum. x begins and ends in silence.
std::vector<double> finer(const std::vector<double>& x, std::size_t factor)
{
    if (factor == 1)
        return x;
    auto spectrum = fft(x);
    if (x.size() % 2 == 0)
        spectrum.back() *= 0.5;  // the Nyquist line stands for both its sides
    spectrum.resize(factor * x.size() / 2 + 1, 0.0);
    auto result = inverseFft(spectrum, factor * x.size());
    for (auto& value : result)
        value *= static_cast<double>(factor);
    return result;
}

}  // namespace

std::vector<double> onPlanClock(std::span<const double> x, const PlanClock& clock, double recordedRate, double planRate,
                                std::size_t length, const ResponseFunction& response)
{
    if (clock.step == 1.0 && clock.start == std::floor(clock.start) && !response)
        return stretch(x, static_cast<std::ptrdiff_t>(clock.start), length, 0);

    // The part of the recording that is needed.
    const double begin = std::floor(clock.at(-margin));
    const auto fade = static_cast<std::size_t>(margin / 2 * clock.step);
    const auto count = quickLength(
        static_cast<std::size_t>(std::ceil(clock.at(static_cast<double>(length) + margin) - begin)));
    const auto part = stretch(x, static_cast<std::ptrdiff_t>(begin), count, fade);

    // At twice the plan's rate or near it, then exactly that. libsoxr leaves errors in the upper half of its band,
    // where nothing is now.
    std::size_t factor = recordedRate >= 1.8 * planRate ? 1 : 2;
    while (static_cast<double>(factor) * recordedRate < 1.8 * planRate)
        factor *= 2;
    auto twice = resampled(finer(part, factor), clock.step * static_cast<double>(factor) / 2.0);
    const double first = 2.0 * (clock.start - begin) / clock.step;  // where the plan begins in it

    const auto half = quickLength((twice.size() + 1) / 2);
    twice.resize(2 * half, 0.0);
    const auto fine = fft(twice);
    std::vector<std::complex<double>> spectrum(half / 2 + 1);
    for (std::size_t k = 0; k < spectrum.size(); ++k) {
        const double cycles = static_cast<double>(k) / static_cast<double>(2 * half);
        const auto turned = fine[k] * std::polar(0.5, 2.0 * std::numbers::pi * cycles * first);
        spectrum[k] = response ? turned / response(cycles * 2.0 * planRate) : turned;
    }
    spectrum.front() = std::abs(spectrum.front()) * (fine.front().real() < 0 ? -1.0 : 1.0);  // a mean is real
    spectrum.back() = 0.0;
    auto read = inverseFft(spectrum, half);
    read.resize(length);
    return read;
}

}  // namespace excursion
