// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Bench.h"

#include "Bench/Resampling.h"
#include "Bench/Run.h"
#include "Bench/Stimulus.h"
#include "Engine/Error.h"
#include "Engine/Signal/Level.h"

#include <algorithm>
#include <cmath>

namespace excursion::bench {
namespace {

constexpr int tail = 2048;  // samples played after the last kept one, so that the decimator has a future

void check(const BenchSetup& setup)
{
    const auto& plan = setup.excitation;
    const auto refuse = [](const std::string& reason) {
        throw Error(Error::Kind::usage, "The virtual bench cannot play this: " + reason);
    };
    if (!(setup.sampleRate > 0.0))
        refuse("the sample rate must be positive.");
    if (plan.period < 1536 || plan.settlePeriods < 1 || plan.periods < 1 || plan.realizations < 1
        || plan.levels.empty())
        refuse("it needs a period of at least 1536 samples, one settling and one kept period, one realization and one "
               "level.");
    if (!(plan.bandLow > 0.0 && plan.bandLow < plan.bandHigh && plan.bandHigh <= 0.42 * setup.sampleRate))
        refuse("the band must be positive, ascending and end below 0.42 times the sample rate.");
    if (std::find(setup.channels.begin(), setup.channels.end(), Quantity::force) != setup.channels.end())
        refuse("it has no force sensor.");
}

Channel channelOf(Quantity quantity) { return {quantity, std::string(siUnit(quantity)), 1.0, {}}; }

}  // namespace

Measurement measure(const Loudspeaker& speaker, const BenchSetup& setup, const Progress& progress)
{
    check(setup);
    Measurement take;
    take.sampleRate = setup.sampleRate;
    take.excitation = setup.excitation;
    take.driver = {speaker.name, speaker.coneArea, setup.microphoneDistance};
    auto& plan = *take.excitation;
    if (plan.lines.empty()) {
        Random gridChoice(setup.seed, 1);
        plan.lines = excitedLines(plan, setup.sampleRate, gridChoice);
    }

    const auto voltage = drive(plan, setup.sampleRate, setup.seed, tail, setup.jumps);
    auto record = run(speaker, voltage, setup.sampleRate, setup.channels, setup.microphoneDistance, 0.5 * plan.bandLow,
                      setup.oversampling, progress);

    const auto total = static_cast<std::size_t>(plan.totalSamples());
    const auto loudest = static_cast<std::size_t>(std::max_element(plan.levels.begin(), plan.levels.end())
                                                  - plan.levels.begin());
    const auto levelLength = total / plan.levels.size();
    for (const auto quantity : setup.channels) {
        auto channel = channelOf(quantity);
        auto& fine = record.signals[quantity];
        bendTime(fine, record.oversampling, quantity, setup.faults);
        channel.samples = decimate(fine, record.oversampling, total);
        fine = {};
        const double rms = rmsOf(std::span(channel.samples).subspan(loudest * levelLength, levelLength));
        const auto own = setup.channelNoiseDb.find(quantity);
        Random hiss(setup.seed, 1000 + static_cast<std::uint64_t>(quantity));
        sense(channel, setup.sampleRate, rms, own == setup.channelNoiseDb.end() ? setup.noiseDb : own->second,
              setup.noiseColour, setup.faults, hiss);
        take.channels.push_back(std::move(channel));
    }
    return take;
}

Measurement play(const Loudspeaker& speaker, std::span<const double> voltage, double sampleRate,
                 const std::vector<Quantity>& channels, double microphoneDistance, const Progress& progress)
{
    Measurement take;
    take.sampleRate = sampleRate;
    take.driver = {speaker.name, speaker.coneArea, microphoneDistance};
    std::vector<double> padded(voltage.begin(), voltage.end());
    padded.resize(padded.size() + tail);
    auto record = run(speaker, padded, sampleRate, channels, microphoneDistance, 1.0, 0, progress);
    Random unused(0);
    for (const auto quantity : channels) {
        auto channel = channelOf(quantity);
        channel.samples = decimate(record.signals[quantity], record.oversampling, voltage.size());
        sense(channel, sampleRate, 0.0, -INFINITY, NoiseColour::white, {}, unused);
        take.channels.push_back(std::move(channel));
    }
    return take;
}

}  // namespace excursion::bench
