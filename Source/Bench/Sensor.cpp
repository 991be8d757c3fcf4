// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Sensor.h"

#include "Bench/Resampling.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace excursion::bench {
namespace {

bool concerns(const Fault& fault, Quantity quantity) { return !fault.channel || *fault.channel == quantity; }

double largest(const std::vector<double>& samples)
{
    double peak = 0.0;
    for (const double value : samples)
        peak = std::max(peak, std::abs(value));
    return peak;
}

}  // namespace

std::string_view name(Fault::Kind kind)
{
    static constexpr std::array<std::string_view, 7> names {"delay", "polarity", "clipping", "drift",
                                                            "dead",  "offset",   "hum"};
    return names[static_cast<std::size_t>(kind)];
}

void bendTime(std::vector<double>& fine, int oversampling, Quantity quantity, const std::vector<Fault>& faults)
{
    double delay = 0.0, ppm = 0.0;
    for (const auto& fault : faults)
        if (concerns(fault, quantity)) {
            delay += fault.kind == Fault::Kind::delay ? fault.amount : 0.0;
            ppm += fault.kind == Fault::Kind::drift ? fault.amount : 0.0;
        }
    if (delay == 0.0 && ppm == 0.0)
        return;
    std::vector<double> bent(fine.size());
    for (std::size_t n = 0; n < bent.size(); ++n)
        bent[n] = readBetween(fine, static_cast<double>(n) * (1.0 - 1e-6 * ppm) - delay * oversampling);
    fine = std::move(bent);
}

std::vector<double> noise(std::size_t length, double rms, NoiseColour colour, Random& random)
{
    std::vector<double> samples(length);
    for (auto& value : samples)
        value = rms * random.normal();
    if (colour == NoiseColour::white || length < 4)
        return samples;
    const auto N = smoothLength(length);
    samples.resize(N);
    auto spectrum = fft(samples);
    double sum = 0.0;
    spectrum[0] = 0.0;
    for (std::size_t k = 1; k < spectrum.size(); ++k)
        sum += 1.0 / static_cast<double>(k);
    const double scale = std::sqrt(static_cast<double>(spectrum.size() - 1) / sum);
    for (std::size_t k = 1; k < spectrum.size(); ++k)
        spectrum[k] *= scale / std::sqrt(static_cast<double>(k));
    samples = inverseFft(spectrum, N);
    samples.resize(length);
    return samples;
}

void sense(Channel& channel, double sampleRate, double loudestRms, double noiseDb, NoiseColour colour,
           const std::vector<Fault>& faults, Random& random)
{
    auto& samples = channel.samples;
    std::vector<double> humRms;
    double offset = 0.0, clip = 0.0;
    for (const auto& fault : faults) {
        if (!concerns(fault, channel.quantity))
            continue;
        switch (fault.kind) {
        case Fault::Kind::polarity:
            for (auto& value : samples)
                value = -value;
            break;
        case Fault::Kind::dead: std::fill(samples.begin(), samples.end(), 0.0); break;
        case Fault::Kind::offset: offset += fault.amount * loudestRms; break;
        case Fault::Kind::hum: humRms.push_back(loudestRms * std::pow(10.0, fault.amount / 20.0)); break;
        case Fault::Kind::clipping: clip = fault.amount; break;
        case Fault::Kind::delay:
        case Fault::Kind::drift: break;
        }
    }
    for (const double rms : humRms) {
        const double phase = 2.0 * std::numbers::pi * random.uniform();
        constexpr double part[] {1.0, 0.5, 0.25};  // 50, 150 and 250 Hz
        const double amplitude = rms * std::sqrt(2.0 / (1.0 + 0.25 + 0.0625));
        for (std::size_t n = 0; n < samples.size(); ++n)
            for (int h = 0; h < 3; ++h)
                samples[n] += amplitude * part[h]
                              * std::sin(
                                  (2 * h + 1)
                                  * (2.0 * std::numbers::pi * 50.0 * static_cast<double>(n) / sampleRate + phase));
    }
    if (std::isfinite(noiseDb)) {
        const auto hiss = noise(samples.size(), loudestRms * std::pow(10.0, noiseDb / 20.0), colour, random);
        for (std::size_t n = 0; n < samples.size(); ++n)
            samples[n] += hiss[n];
    }
    for (auto& value : samples)
        value += offset;

    const double peak = largest(samples);
    channel.fullScale = peak > 0.0 ? std::exp2(std::ceil(std::log2(1.25 * peak))) : 1.0;
    if (clip > 0.0 && peak > 0.0) {
        channel.fullScale = clip * peak;
        for (auto& value : samples)
            value = std::clamp(value, -channel.fullScale, channel.fullScale);
    }
}

}  // namespace excursion::bench
