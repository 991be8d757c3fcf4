// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Run.h"

#include "Bench/Resampling.h"
#include "Bench/Simulator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace excursion::bench {
namespace {

constexpr double airDensity = 1.2, soundSpeed = 343.0;

std::vector<double> pressureOf(const std::vector<double>& radiated, const std::vector<double>& position,
                               double coneArea, double distance, double rate)
{
    const double gain = airDensity * coneArea / (2.0 * std::numbers::pi * distance);
    std::vector<double> pressure(radiated.size());
    for (std::size_t n = 0; n < pressure.size(); ++n) {
        const double now = static_cast<double>(n);
        double left = now - distance / soundSpeed * rate;
        // contraction |v|/c: three rounds are exact to 1e-9 of the shift
        for (int round = 0; round < 4 && !position.empty(); ++round)
            left = now - (distance - readBetween(position, left)) / soundSpeed * rate;
        pressure[n] = gain * readBetween(radiated, left);
    }
    return pressure;
}

}  // namespace

int defaultOversampling(const Loudspeaker& speaker, double sampleRate)
{
    int factor = speaker.eddyCurrents ? 4 : 2;
    while (factor * sampleRate < (speaker.eddyCurrents ? 352e3 : 176e3))
        factor *= 2;
    return factor;
}

Record run(const Loudspeaker& speaker, std::span<const double> voltage, double sampleRate,
           const std::vector<Quantity>& channels, double microphoneDistance, double lowest, int oversampling,
           const Progress& progress)
{
    Record record;
    record.sampleRate = sampleRate;
    record.oversampling = oversampling > 0 ? oversampling : defaultOversampling(speaker, sampleRate);
    const double rate = sampleRate * record.oversampling;
    const auto count = voltage.size() * static_cast<std::size_t>(record.oversampling);

    std::array<std::vector<double>, 3> drive;
    for (int j = 0; j < 3; ++j)
        // ends of steps on the grid
        drive[j] = interpolate(voltage, record.oversampling, Radau::points()[j] - 1.0);

    const auto wants = [&](Quantity quantity) {
        return std::find(channels.begin(), channels.end(), quantity) != channels.end();
    };
    std::vector<std::pair<std::vector<double>*, double Simulator::Sample::*>> taps;
    std::vector<double> radiated, position;
    const auto tap = [&](std::vector<double>& store, double Simulator::Sample::*member) {
        store.assign(count, 0.0);
        taps.emplace_back(&store, member);
    };
    if (wants(Quantity::current))
        tap(record.signals[Quantity::current], &Simulator::Sample::current);
    if (wants(Quantity::displacement))
        tap(record.signals[Quantity::displacement], &Simulator::Sample::displacement);
    if (wants(Quantity::velocity))
        tap(record.signals[Quantity::velocity], &Simulator::Sample::velocity);
    if (wants(Quantity::acceleration))
        tap(record.signals[Quantity::acceleration], &Simulator::Sample::acceleration);
    if (wants(Quantity::pressure)) {
        tap(radiated, &Simulator::Sample::radiated);
        if (speaker.doppler)
            tap(position, &Simulator::Sample::displacement);
    }

    constexpr double turn = 2.0 * std::numbers::pi;
    Simulator simulator(speaker, 1.0 / rate, turn * 0.5 * sampleRate, turn * lowest);
    for (std::size_t n = 1; n < count; ++n) {
        const auto& sample = simulator.step({drive[0][n], drive[1][n], drive[2][n]});
        for (const auto& [store, member] : taps)
            (*store)[n] = sample.*member;
        if (n % 65536 == 0)
            progress.at(static_cast<double>(n) / static_cast<double>(count), "playing");
    }
    record.coilTemperature = simulator.coilTemperature();
    if (wants(Quantity::pressure))
        record.signals[Quantity::pressure] = pressureOf(radiated, position, speaker.coneArea, microphoneDistance, rate);
    record.signals[Quantity::voltage] = std::move(drive[2]);
    return record;
}

}  // namespace excursion::bench
