// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Bench/Bench.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

namespace excursion::bench {

/// A short, noise-free take of the dissertation's driver with every sensor.
inline BenchSetup quietSetup()
{
    BenchSetup setup;
    using enum Quantity;
    setup.channels = {voltage, current, displacement, velocity, acceleration, pressure};
    setup.noiseDb = -INFINITY;
    setup.excitation.levels = {5.0};
    setup.excitation.realizations = 1;
    setup.excitation.periods = 1;
    return setup;
}

/// The spectrum of the last period of a channel.
inline std::vector<std::complex<double>> lastPeriod(const Measurement& take, Quantity quantity)
{
    const auto& samples = take.find(quantity)->samples;
    const auto N = static_cast<std::size_t>(take.excitation->period);
    return fft(std::span(samples).last(N));
}

inline double dB(double ratio) { return 20.0 * std::log10(ratio + 1e-300); }

/// Relative rms difference within the band, and the worst excited line's, both in dB.
struct Difference {
    double band, worstLine;
};
inline Difference difference(const Measurement& a, const Measurement& b, Quantity quantity)
{
    const auto X = lastPeriod(a, quantity), Y = lastPeriod(b, quantity);
    const auto& plan = *a.excitation;
    double error = 0.0, power = 0.0, worst = 0.0;
    for (int k = plan.lines.front(); k <= plan.lines.back(); ++k) {
        error += std::norm(X[static_cast<std::size_t>(k)] - Y[static_cast<std::size_t>(k)]);
        power += std::norm(Y[static_cast<std::size_t>(k)]);
    }
    for (const int line : plan.lines) {
        const auto k = static_cast<std::size_t>(line);
        worst = std::max(worst, std::abs(X[k] - Y[k]) / std::abs(Y[k]));
    }
    return {dB(std::sqrt(error / power)), dB(worst)};
}

/// The power on the lines that are not excited (odd or even ones) against that on all lines within the band, in dB.
inline double distortion(const Measurement& take, Quantity quantity, bool odd)
{
    const auto X = lastPeriod(take, quantity);
    const auto& lines = take.excitation->lines;
    double silent = 0.0, all = 0.0;
    for (int k = lines.front(); k <= lines.back(); ++k) {
        const double power = std::norm(X[static_cast<std::size_t>(k)]);
        all += power;
        if ((k % 2 != 0) == odd && !std::binary_search(lines.begin(), lines.end(), k))
            silent += power;
    }
    return dB(std::sqrt(silent / all));
}

}  // namespace excursion::bench
