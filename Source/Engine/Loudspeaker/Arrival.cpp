// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Arrival.h"

#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

namespace excursion {
namespace {

// values a sample between which a polynomial goes: with eight points 1e-5 is left at 0.42 of the rate, less below, and
// half a percent when rough
constexpr int finely = 4, roughly = 2;

/// The periodic record of N samples that has this spectrum, at `finer` times its rate, by zeros above its own lines.
std::vector<double> refined(std::vector<std::complex<double>> spectrum, std::size_t N, int finer)
{
    if (N % 2 == 0)
        spectrum.back() *= 0.5;  // the Nyquist line stands for both its sides
    const auto length = static_cast<std::size_t>(finer) * N;
    spectrum.resize(length / 2 + 1, 0.0);
    auto fine = inverseFft(spectrum, length);
    for (auto& value : fine)
        value *= finer;
    return fine;
}

/// Lagrange's polynomial through eight of the finer values: its weights at a place.
/// @param sample  the place, samples
Arrival::Taps tapsAt(double sample, int finer)
{
    constexpr auto points = Arrival::points;
    static constexpr std::array<double, points> inverse = [] {  // 1/prod (k - j)
        std::array<double, points> result {};
        for (std::size_t k = 0; k < points; ++k) {
            double product = 1.0;
            for (std::size_t j = 0; j < points; ++j)
                if (j != k)
                    product *= static_cast<double>(k) - static_cast<double>(j);
            result[k] = 1.0 / product;
        }
        return result;
    }();
    constexpr int before = points / 2 - 1;  // of the points that lie on the left
    const double place = sample * finer, floor = std::floor(place), fraction = place - floor + before;
    Arrival::Taps taps {static_cast<std::ptrdiff_t>(floor) - before, {}};
    std::array<double, points> above;  // prod (fraction - j) over j > k
    above[points - 1] = 1.0;
    for (std::size_t k = points - 1; k > 0; --k)
        above[k - 1] = above[k] * (fraction - static_cast<double>(k));
    double below = 1.0;
    for (std::size_t k = 0; k < points; ++k) {
        taps.weight[k] = inverse[k] * below * above[k];
        below *= fraction - static_cast<double>(k);
    }
    return taps;
}

/// What these weights make of a periodic record.
double weighted(const std::vector<double>& fine, const Arrival::Taps& taps)
{
    constexpr auto points = static_cast<std::ptrdiff_t>(Arrival::points);
    const auto length = static_cast<std::ptrdiff_t>(fine.size());
    double sum = 0.0;
    if (taps.first < 0 || taps.first + points > length) {  // only where the period begins and ends
        for (std::ptrdiff_t k = 0; k < points; ++k)
            sum += taps.weight[static_cast<std::size_t>(k)]
                   * fine[static_cast<std::size_t>(((taps.first + k) % length + length) % length)];
        return sum;
    }
    const double* values = fine.data() + taps.first;
    for (std::size_t k = 0; k < Arrival::points; ++k)
        sum += taps.weight[k] * values[k];
    return sum;
}

}  // namespace

std::vector<double> slopeOf(std::span<const double> samples, double sampleRate)
{
    auto spectrum = fft(samples);
    const double step = 2.0 * std::numbers::pi * sampleRate / static_cast<double>(samples.size());
    for (std::size_t k = 0; k < spectrum.size(); ++k)
        spectrum[k] *= std::complex<double>(0.0, step * static_cast<double>(k));
    if (samples.size() % 2 == 0)
        spectrum.back() = 0.0;  // the slope of the Nyquist line has none
    return inverseFft(spectrum, samples.size());
}

std::vector<double> slopeByLeaving(std::span<const double> samples, std::span<const double> lateness, double sampleRate)
{
    auto slope = slopeOf(samples, sampleRate);
    const auto drift = slopeOf(lateness, sampleRate);
    for (std::size_t n = 0; n < slope.size(); ++n)
        slope[n] /= 1.0 + drift[n];
    return slope;
}

Arrival::Arrival(std::span<const double> lateness, double sampleRate)
{
    if (std::all_of(lateness.begin(), lateness.end(), [](double l) { return l == 0.0; }))
        return;
    const std::size_t N = lateness.size();
    auto spectrum = fft(lateness);
    for (auto& line : spectrum)
        line *= sampleRate;
    constexpr int finer = finely;
    const auto late = refined(std::move(spectrum), N, finer);
    const auto length = static_cast<std::ptrdiff_t>(late.size());
    left_.resize(N);
    for (std::size_t n = 0; n < N; ++n) {
        const double t = static_cast<double>(n);
        double s = t - late[finer * n];
        constexpr int enough = 8;  // from a start that is right to the square of the Mach number
        for (int k = 0; k < enough; ++k) {
            // A rough slope will do: it steers the iteration, and what it is off by is small beside one.
            auto nearest = static_cast<std::ptrdiff_t>(finer * s) % length;
            nearest += nearest < 0 ? length : 0;
            const auto from = static_cast<std::size_t>(std::min(nearest, length - 2));
            const double change = (s + weighted(late, tapsAt(s, finer)) - t)
                                  / (1.0 + finer * (late[from + 1] - late[from]));
            s -= change;
            if (!(std::abs(change) > 1e-9))
                break;
        }
        left_[n] = s;
    }
    rough_.reserve(N);
    for (const double s : left_)
        rough_.push_back(tapsAt(s, roughly));
}

std::vector<double> Arrival::heard(std::span<const double> samples) const
{
    if (left_.empty())
        return {samples.begin(), samples.end()};
    const std::size_t N = samples.size();
    const auto fine = refined(fft(samples), N, finely);
    std::vector<double> result(N);
    for (std::size_t n = 0; n < N; ++n)
        result[n] = weighted(fine, tapsAt(left_[n], finely));
    return result;
}

std::vector<double> Arrival::heardRoughly(std::vector<std::complex<double>> spectrum, std::size_t N) const
{
    if (left_.empty())
        return inverseFft(spectrum, N);
    const auto fine = refined(std::move(spectrum), N, roughly);
    std::vector<double> result(N);
    for (std::size_t n = 0; n < N; ++n)
        result[n] = weighted(fine, rough_[n]);
    return result;
}

}  // namespace excursion
