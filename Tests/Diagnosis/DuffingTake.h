// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Multisine.h"
#include "Engine/Take/Measurement.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace excursion::test {

/// What an electronic Duffing oscillator, x'' + 2 d w x' + w^2 (1 + hardening x^2) x = w^2 u, gives when a multisine u
/// of 1 V rms is read as a force and its output as a displacement: two levels with white noise (20 dB less of it on the
/// input), solved by the classical Runge-Kutta method.
/// @param wander  relative rms by which w^2 wanders, with a time constant of 50 ms
inline Measurement duffingTake(double hardening, double noiseDb, std::uint64_t seed, double wander = 0.0)
{
    constexpr int steps = 16;  // a sample
    constexpr double omega = 440.0, damping = 0.1;
    MultisineOptions tones;
    tones.sampleRate = 1024.0;
    tones.period = 1024;
    tones.shape = Shape::white;
    tones.bandLow = 4.0;
    tones.bandHigh = 160.0;
    tones.seed = seed;
    Measurement take;
    take.sampleRate = tones.sampleRate;
    take.excitation = Excitation {
        tones.period, 2, 3, 3, {0.3, 1.0}, "odd-random", "white", tones.bandLow, tones.bandHigh, chooseLines(tones)};
    const auto& e = *take.excitation;
    Channel force {Quantity::force, "N", 1.0, {}}, displacement {Quantity::displacement, "m", 1.0, {}};
    const auto N = static_cast<std::size_t>(e.period), fineLength = 2 * steps * N;
    const double h = 1.0 / (tones.sampleRate * steps);
    double x = 0.0, v = 0.0;
    double stiffness = 1.0;
    std::mt19937_64 wanders(seed + 1);
    std::normal_distribution<double> step(0.0, 1.0);
    const double keeps = std::exp(-1.0 / (0.05 * tones.sampleRate));
    const auto acceleration = [&](double position, double velocity, double u) {
        return omega * omega * (u - (stiffness + hardening * position * position) * position)
               - 2.0 * damping * omega * velocity;
    };
    for (const double level : e.levels)
        for (int realization = 0; realization < e.realizations; ++realization) {
            tones.rms = level;
            auto spectrum = fft(multisine(tones, e.lines, realization));
            spectrum.resize(fineLength / 2 + 1);  // two values a step
            auto u = inverseFft(spectrum, fineLength);
            for (auto& value : u)
                value *= 2.0 * steps;
            for (std::size_t n = 0; n < N * static_cast<std::size_t>(e.periodsPerRealization()); ++n) {
                const std::size_t at = n % N * 2 * steps;
                force.samples.push_back(u[at]);
                displacement.samples.push_back(x);
                if (wander > 0.0)
                    stiffness = 1.0 + keeps * (stiffness - 1.0)
                                + wander * std::sqrt(1.0 - keeps * keeps) * step(wanders);
                for (std::size_t k = at; k < at + 2 * steps; k += 2) {
                    const double u1 = u[k], u2 = u[k + 1], u3 = u[(k + 2) % fineLength];
                    const double v1 = v, a1 = acceleration(x, v, u1);
                    const double v2 = v + 0.5 * h * a1, a2 = acceleration(x + 0.5 * h * v1, v2, u2);
                    const double v3 = v + 0.5 * h * a2, a3 = acceleration(x + 0.5 * h * v2, v3, u2);
                    const double v4 = v + h * a3, a4 = acceleration(x + h * v3, v4, u3);
                    x += h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
                    v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
                }
            }
        }
    std::mt19937_64 random(seed);
    for (auto* channel : {&force, &displacement}) {
        double power = 0.0;
        for (const double value : channel->samples)
            power += value * value / static_cast<double>(channel->samples.size());
        std::normal_distribution<double> noise(
            0.0, std::sqrt(power) * std::pow(10.0, (channel == &force ? noiseDb - 20.0 : noiseDb) / 20.0));
        for (auto& value : channel->samples)
            value += noise(random);
        take.channels.push_back(std::move(*channel));
    }
    return take;
}

}  // namespace excursion::test
