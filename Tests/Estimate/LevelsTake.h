// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Signal/Fft.h"
#include "Engine/Take/Measurement.h"

#include <cmath>
#include <complex>
#include <random>
#include <vector>

/// A take of two levels and three realizations of a multisine through a resistor.
namespace excursion::levelsTake {

inline constexpr int N = 1024, settle = 1, periods = 4, realizations = 3;
inline constexpr double sampleRate = 8000.0;
inline constexpr int fold = 2;  // times the rate at which the widest band is simulated

/// Odd lines 3 .. last (or all of them) at random phases; the current is the voltage over 4 ohm, two samples later.
/// @param faint   the realization that is only 0.7 times as loud
/// @param noise   rms of white noise on the current, in A, and of a tenth of it on the voltage, in V
inline Measurement take(int faint, double noise, int last = 401, int apart = 2)
{
    Measurement result;
    result.sampleRate = sampleRate;
    Excitation e;
    e.period = N;
    e.settlePeriods = settle;
    e.periods = periods;
    e.realizations = realizations;
    e.levels = {1.0, 3.0};
    e.grid = apart == 2 ? "odd" : "full";
    for (int k = 3; k <= last; k += apart)
        e.lines.push_back(k);
    e.bandLow = 3 * sampleRate / N;
    e.bandHigh = last * sampleRate / N;
    std::mt19937_64 random(11);
    std::normal_distribution<double> normal;
    std::vector<std::vector<double>> multisines;
    for (int r = 0; r < realizations; ++r) {
        std::vector<std::complex<double>> spectrum(N / 2 + 1, 0.0);
        for (const int k : e.lines)
            spectrum[static_cast<std::size_t>(k)] = std::polar((r == faint ? 0.7 : 1.0) * N / 20.0,
                                                               std::uniform_real_distribution<>(0.0, 6.28)(random));
        multisines.push_back(inverseFft(spectrum, N));
    }
    Channel voltage {Quantity::voltage, "V", 100.0, {}}, current {Quantity::current, "A", 100.0, {}};
    for (const double level : e.levels)
        for (const auto& period : multisines)
            for (int n = 0; n < e.samplesPerRealization(); ++n) {
                voltage.samples.push_back(level * period[static_cast<std::size_t>(n % N)]
                                          + 0.1 * noise * normal(random));
                current.samples.push_back(0.25 * level * period[static_cast<std::size_t>((n + N - 2) % N)]
                                          + noise * normal(random));
            }
    result.channels = {voltage, current};
    result.excitation = e;
    return result;
}

}  // namespace excursion::levelsTake
