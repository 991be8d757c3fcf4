// SPDX-License-Identifier: GPL-3.0-or-later
// What a fit takes from a record before it begins.
#include "Engine/Loudspeaker/Fit.h"

#include "Engine/Loudspeaker/OutputError.h"
#include "Engine/Loudspeaker/Sensors.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Level.h"
#include "Engine/Take/Motion.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace excursion {
namespace {

/// Peak of a channel's window, integrated `integrations` times (negative: differentiated), without its mean. Lines that
/// do not stand out of the noise are left out: a motion that is differentiated over a wide band would show it alone.
double measuredPeak(const Record& record, const Section& section, std::size_t channel, int integrations)
{
    constexpr double standsOut = 3.0;
    auto spectrum = section.measured[channel];
    spectrum.front() = 0.0;
    for (std::size_t k = 1; k < spectrum.size(); ++k) {
        const double f = record.frequency(section, k);
        // Below the band an integrated channel holds little but amplified noise, above it a differentiated one.
        const bool heard = !record.noiseKnown || std::abs(spectrum[k]) > standsOut * section.deviation[channel][k];
        const bool trusted = heard && (integrations <= 0 || f > 0.5 * record.bandLow)
                             && (integrations >= 0 || f < 1.5 * record.bandHigh);
        spectrum[k] = trusted
                          ? spectrum[k] / std::pow(std::complex<double>(0.0, 2.0 * std::numbers::pi * f), integrations)
                          : 0.0;
    }
    return peakOf(inverseFft(spectrum, section.window));
}

}  // namespace

int substepsFor(const Model& model, const Record& record, double tolerance)
{
    const Section* loudest = nullptr;
    double peak = -1.0;
    for (const auto& section : record.sections)
        if (const double p = peakOf(section.input); p > peak) {
            peak = p;
            loudest = &section;
        }
    // What nobody measured may be off: the turns of a cone with friction are sharp in its acceleration alone.
    constexpr double finest = 1e-6, coarsest = 1e-4, ofNoise = 0.15;
    SimulationOptions options;
    options.tolerance = tolerance > 0.0 ? tolerance : coarsest;
    options.maximumSubsteps = 16;
    for (std::size_t c = 0; c < record.channels.size(); ++c) {
        double asked = options.tolerance;
        if (tolerance <= 0.0 && record.noiseKnown) {
            double noise = 0.0, signal = 0.0;
            for (std::size_t k = 1; k < loudest->measured[c].size(); ++k) {
                noise += loudest->deviation[c][k] * loudest->deviation[c][k];
                signal += std::norm(loudest->measured[c][k]);
            }
            if (signal > 0.0)
                asked = std::clamp(ofNoise * std::sqrt(noise / signal), finest, coarsest);
        }
        const auto [place, isNew] = options.tolerances.try_emplace(mainTraceOf(record.channels[c]), asked);
        if (!isNew)
            place->second = std::min(place->second, asked);
    }
    // From rest a short period does not come near the motion that it settles to.
    constexpr std::size_t enough = 8192;
    auto played = loudest->input;
    while (loudest->periodic && !played.empty() && played.size() < enough)
        played.insert(played.end(), loudest->input.begin(), loudest->input.end());
    return chooseSubsteps(model, played, record.sampleRate, options).substeps;
}

bool warms(const Model& model)
{
    return std::any_of(model.components.begin(), model.components.end(),
                       [](const Component& c) { return c.effect->slow() && isAtWork(c); });
}

void adapt(Record& record, const Model& model)
{
    if (record.sections.empty() || !record.sections.front().periodic)
        return;
    for (auto& section : record.sections) {
        if (section.inputVariance.empty())
            continue;
        const auto U = fft(section.input);
        const auto [first, last] = record.lineRange(section);
        std::vector<std::size_t> played;
        std::vector<double> frequency;
        for (std::size_t k = first; k <= last; ++k)
            if (std::norm(U[k]) > section.inputVariance[k]) {
                played.push_back(k);
                frequency.push_back(record.frequency(section, k));
            }
        const auto responses = respond(model, record.channels, frequency);
        section.inputNoise.assign(record.channels.size(), std::vector<std::complex<double>>(U.size()));
        for (std::size_t n = 0; n < played.size(); ++n) {
            const double input = std::sqrt(section.inputVariance[played[n]]);
            for (auto* deviation : {&section.deviation, &section.deviationWithoutDrift})
                for (std::size_t c = 0; c < deviation->size(); ++c) {
                    auto& own = (*deviation)[c][played[n]];
                    own = std::hypot(own, std::abs(responses[c].value[n]) * input);
                }
            for (std::size_t c = 0; c < record.channels.size(); ++c)
                section.inputNoise[c][played[n]] = responses[c].value[n] * input;
        }
        section.inputVariance.clear();
    }
    record.leadIn = settlingTime(model, record);
    if (warms(model))
        takeDriftOutOfNoise(record);
}

OperatingRange visitedRange(const Model& model, const Record& record, int degree)
{
    OperatingRange operatingRange;
    operatingRange.degree = degree;
    operatingRange.lowFrequency = record.bandLow;
    operatingRange.highFrequency = record.bandHigh;
    if (!record.sections.empty() && record.sections.back().end > 0.0)
        operatingRange.duration = record.sections.back().end;
    double x = 0.0, v = 0.0, i = 0.0;
    for (const auto& section : record.sections)
        for (std::size_t c = 0; c < record.channels.size(); ++c) {
            if (record.channels[c] == Quantity::current)
                i = std::max(i, measuredPeak(record, section, c, 0));
            if (const auto n = integrationsToDisplacement(record.channels[c])) {
                x = std::max(x, measuredPeak(record, section, c, *n));
                v = std::max(v, measuredPeak(record, section, c, *n - 1));
            }
        }
    if (x == 0.0 || (i == 0.0 && model.electrical())) {
        const StepDivision division(model, record.sampleRate, 1);
        double simulatedX = 0.0, simulatedV = 0.0, simulatedI = 0.0;
        for (const auto& section : record.sections) {
            Trajectory run;
            const auto drive = record.drive(section);
            if (!integrate(model, Drive(drive, record.sampleRate, 1), division, {drive.size() - section.window}, run))
                continue;
            simulatedX = std::max(simulatedX, peakOf(run.displacement));
            simulatedV = std::max(simulatedV, peakOf(run.velocity));
            simulatedI = std::max(simulatedI, peakOf(run.current));
        }
        if (x == 0.0) {
            x = simulatedX;
            v = simulatedV;
        }
        if (i == 0.0)
            i = simulatedI;
    }
    // Where nothing moves (the current of a driver without a coil) the default stands.
    const auto keep = [](double peak, double& to) {
        if (peak > 0.0)
            to = 1.02 * peak;
    };
    keep(x, operatingRange.displacement);
    keep(v, operatingRange.velocity);
    keep(i, operatingRange.current);
    return operatingRange;
}

}  // namespace excursion
