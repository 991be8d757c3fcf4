// SPDX-License-Identifier: GPL-3.0-or-later
// A virtual loudspeaker behind a simulated device is measured, and the device is broken in every way.
#include "Audio/ChooseDevice.h"
#include "Audio/Measure.h"
#include "Audio/SimulatedDevice.h"
#include "Engine/Check/TakeCheck.h"
#include "Engine/Import/ImportRecording.h"
#include "Engine/Take/ExcitationPlan.h"
#include "Scratch.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>

using namespace excursion;
using namespace excursion::audio;
using namespace excursion::test;

namespace {

constexpr double sampleRate = 32000.0;

const Measurement& shortPlan()
{
    static const Measurement plan = [] {
        ExcitationPlanOptions options;
        options.multisine.sampleRate = sampleRate;
        options.multisine.period = 4096;
        options.multisine.bandLow = 20.0;
        options.multisine.bandHigh = 2000.0;
        options.levels = {1.0, 3.0};
        options.periods = 2;
        options.realizations = 1;
        return planExcitation(options);
    }();
    return plan;
}

MeasureOptions measuring()
{
    const auto& plan = shortPlan();
    MeasureOptions options;
    auto& procedure = options.procedure = procedureFor(plan, {}, 16.0);
    procedure.recorded = 3;
    procedure.inputs = {
        {0, Quantity::voltage, 16.0, {}}, {1, Quantity::current, 4.0, {}}, {2, Quantity::displacement, 8e-3, {}}};
    procedure.rise = 1.0;
    procedure.ringSeconds = 60.0;  // the simulation is quicker than sound
    return options;
}

/// A wiring whose loudspeaker can be asked afterwards.
struct Wired {
    std::shared_ptr<WiredLoudspeaker> speaker;
    SimulatedSystem system {[this] {
        speaker = std::make_shared<WiredLoudspeaker>(bench::Loudspeaker(), sampleRate);
        return Wiring([one = speaker](float played) { return (*one)(played); });
    }};
    Measured measure(const MeasureOptions& options)
    {
        return audio::measure(system, system.devices().front(), options);
    }
};

/// Where a cable does, for what goes wrong with devices.
SimulatedSystem cables(std::vector<Fault> faults = {})
{
    return SimulatedSystem(
        [] {
            return Wiring([n = 0](float played) mutable {
                const float x = 0.5f * played + (++n % 2 ? 1e-4f : -1e-4f);
                return std::vector<float> {x, x, x};
            });
        },
        std::move(faults));
}

float peakOf(const std::vector<float>& samples)
{
    float peak = 0.0f;
    for (const float sample : samples)
        peak = std::max(peak, std::abs(sample));
    return peak;
}

/// The last samples that are not silent fall like a cosine: no more than a fade's slope from one to the next.
void checkFade(const std::vector<float>& played)
{
    auto end = played.size();
    while (end > 0 && played[end - 1] == 0.0f)
        --end;
    REQUIRE(end > 2000);
    const auto fade = static_cast<std::size_t>(0.03 * sampleRate);
    const auto peak = [&](std::size_t from, std::size_t to) {
        float most = 0.0f;
        for (auto n = from; n < to; ++n)
            most = std::max(most, std::abs(played[n]));
        return most;
    };
    CHECK(peak(end - fade / 8, end) < 0.05f * peak(end - 4 * fade, end - fade));
}

}  // namespace

TEST_CASE("A virtual loudspeaker is measured through a device, and the take is fit for use", "[audio]")
{
    Wired wired;
    auto options = measuring();
    int reports = 0;
    double share = 0.0;
    options.report = [&](const Status& status) {
        ++reports;
        CHECK(status.fraction >= share);
        CHECK(status.meters.size() == 3);
        share = status.fraction;
    };
    auto measured = wired.measure(options);
    CHECK(measured.attempts == 1);
    CHECK(measured.remarks.empty());
    CHECK(reports > 0);
    REQUIRE(measured.channels.size() == 3);

    RecordingOptions recording;
    recording.plan = shortPlan();
    for (const auto* text : {"1=voltage:16", "2=current:4", "3=displacement:8mm"})
        recording.map.push_back(parseChannelMapping(text));
    Wav sound;
    sound.sampleRate = static_cast<int>(sampleRate);
    for (const auto& channel : measured.channels)
        sound.channels.emplace_back(channel.begin(), channel.end());
    recording.sounds.push_back({"the recording", sound});
    const auto imported = importRecording(recording);
    CHECK(imported.files.at(0).alignment.synchronous);
    const auto& voltage = imported.take.find(Quantity::voltage)->samples;
    const auto& played = shortPlan().input().samples;
    REQUIRE(voltage.size() == played.size());
    double worst = 0.0;
    for (std::size_t n = 0; n < voltage.size(); ++n)
        worst = std::max(worst, std::abs(voltage[n] - played[n]));
    CHECK(worst < 0.003);
    const auto report = check(imported.take);
    INFO(report.verdict());
    CHECK(report.fitForUse());
}

TEST_CASE("Sweeps are measured after a rise of the loudest one, and are a take that knows them", "[audio]")
{
    SweepExcitation sweeps;
    sweeps.bandLow = 30.0;
    sweeps.bandHigh = 4000.0;
    sweeps.seconds = 1.0;
    sweeps.silence = 0.6;
    sweeps.levels = {1.0, 2.0};
    const auto plan = planSweep(sweeps, sampleRate);
    auto options = measuring();
    const auto inputs = options.procedure.inputs;
    options.procedure = procedureFor(plan, sweeps, 16.0);
    options.procedure.inputs = inputs;
    options.procedure.recorded = 3;
    options.procedure.ringSeconds = 60.0;
    const auto& loudest = options.procedure.loudest;
    CHECK(peakOf(loudest) == Approx(2.0 * std::sqrt(2.0) / 16.0).epsilon(0.01));
    CHECK(options.procedure.rise > 9.9 * static_cast<double>(loudest.size()) / sampleRate);
    Wired wired;
    const auto measured = wired.measure(options);
    RecordingOptions recording;
    recording.plan = plan;
    recording.sweep = sweeps;
    for (const auto* text : {"1=voltage:16", "2=current:4", "3=displacement:8mm"})
        recording.map.push_back(parseChannelMapping(text));
    Wav sound {static_cast<int>(sampleRate), {}};
    for (const auto& channel : measured.channels)
        sound.channels.emplace_back(channel.begin(), channel.end());
    recording.sounds.push_back({"the recording", sound});
    const auto imported = importRecording(recording);
    REQUIRE(imported.sweep);
    CHECK(imported.sweep->levels.size() == 2);
    CHECK(imported.take.find(Quantity::voltage)->samples.size() == plan.input().samples.size());

    // Where nothing is played, nothing need move: the inputs of a digital loop are silent then.
    SimulatedSystem loop([] { return Wiring([](float played) { return std::vector<float>(3, 0.5f * played); }); });
    CHECK_NOTHROW(audio::measure(loop, loop.devices().front(), options));
}

TEST_CASE("The rise of long sweeps comes to their low notes step by step", "[audio]")
{
    constexpr double limit = 0.4e-3;
    SweepExcitation sweeps;  // 8 s from 20 Hz
    sweeps.bandHigh = 10000.0;
    sweeps.levels = {3.0};
    auto options = measuring();
    const auto inputs = options.procedure.inputs;
    options.procedure = procedureFor(planSweep(sweeps, sampleRate), sweeps, 16.0);
    const auto& loudest = options.procedure.loudest;
    CHECK(static_cast<double>(loudest.size()) / sampleRate < 4.0);
    // its lowest notes are as loud as the others, as they are in the plan
    CHECK(peakOf({loudest.begin(), loudest.begin() + static_cast<std::ptrdiff_t>(loudest.size() / 20)})
          > 0.95f * peakOf(loudest));
    options.procedure.inputs = inputs;
    options.procedure.recorded = 3;
    options.procedure.ringSeconds = 90.0;
    options.procedure.inputs[2].limit = limit;
    Wired limited;
    CHECK_THROWS_WITH(limited.measure(options), Catch::Contains("in the rise"));
    CHECK(limited.speaker->farthest > 0.9 * limit);
    CHECK(limited.speaker->farthest < 1.7 * limit);
}

TEST_CASE("What is played must sound, and fit the output", "[audio]")
{
    const auto& plan = shortPlan();
    double peak = 0.0;
    for (const double volts : plan.input().samples)
        peak = std::max(peak, std::abs(volts));
    CHECK_NOTHROW(procedureFor(plan, {}, 1.001 * peak));
    CHECK_THROWS_WITH(procedureFor(plan, {}, 0.999 * peak), Catch::Contains("full scale"));
    auto silent = plan;
    for (auto& channel : silent.channels)
        std::fill(channel.samples.begin(), channel.samples.end(), 0.0);
    CHECK_THROWS_AS(procedureFor(silent, {}, 16.0), Error);
}

TEST_CASE("The cone of a virtual loudspeaker does not go far beyond its limit", "[audio]")
{
    constexpr double limit = 0.5e-3;
    Wired wired;
    auto options = measuring();
    options.procedure.rise = 4.0;
    options.procedure.inputs[2].limit = limit;
    refused(Error::Kind::data, "The displacement reached", [&] { wired.measure(options); });
    CHECK(wired.speaker->farthest > 0.95 * limit);
    // 10 dB a second, from one period to the next, and while a block and the converters delay
    CHECK(wired.speaker->farthest < 1.3 * limit);
    checkFade(wired.system.played.front());
}

TEST_CASE("A measurement that lost samples is repeated without the rise", "[audio]")
{
    const Fault first {Fault::Kind::xrun, 85000}, again {Fault::Kind::xrun, 40000};
    auto once = cables({first});
    const auto measured = measure(once, once.devices().front(), measuring());
    CHECK(measured.attempts == 2);
    REQUIRE(measured.remarks.size() == 1);
    CHECK_THAT(measured.remarks.front(), Catch::Contains("Samples were lost at") && Catch::Contains("played again"));
    CHECK(once.played.size() == 2);
    checkFade(once.played.front());
    CHECK(measured.channels[0].size() == static_cast<std::size_t>(1.5 * sampleRate) + shortPlan().length());

    auto always = cables({first, again, again});
    refused(Error::Kind::input, "in 3 attempts", [&] { measure(always, always.devices().front(), measuring()); });
    CHECK(always.played.size() == 3);
}

TEST_CASE("A device that goes away, or hangs, is told within its patience", "[audio]")
{
    for (const auto kind : {Fault::Kind::gone, Fault::Kind::hangs})
        for (const double at : {0.2, 1.0, 3.0}) {
            auto system = cables({{kind, static_cast<std::size_t>(at * sampleRate)}});
            auto options = measuring();
            options.patience = 0.3;
            const auto begun = std::chrono::steady_clock::now();
            refused(Error::Kind::input, "'bench' is gone", [&] { measure(system, system.devices().front(), options); });
            CHECK(std::chrono::steady_clock::now() - begun < std::chrono::seconds(20));
        }
}

TEST_CASE("A measurement that is told to stop fades out first", "[audio]")
{
    auto system = cables();
    auto options = measuring();
    std::stop_source stop;
    options.stop = stop.get_token();
    options.report = [&](const Status& status) {
        if (status.stage == Stage::rising || status.stage == Stage::playing)
            stop.request_stop();
    };
    // long enough to be caught at
    while (options.procedure.sound.size() < static_cast<std::size_t>(300 * sampleRate))
        options.procedure.sound.insert(options.procedure.sound.end(), options.procedure.sound.begin(),
                                       options.procedure.sound.begin() + 8192);
    refused(Error::Kind::cancelled, "was stopped", [&] { measure(system, system.devices().front(), options); });
    checkFade(system.played.front());
}

TEST_CASE("An input that is not connected is told", "[audio]")
{
    SimulatedSystem system([] {
        return Wiring([n = 0](float played) mutable {
            const float noise = ++n % 2 ? 1e-4f : -1e-4f;
            return std::vector<float> {played + noise, noise, played + noise};
        });
    });
    const auto measured = measure(system, system.devices().front(), measuring());
    REQUIRE(measured.remarks.size() == 1);
    CHECK_THAT(measured.remarks.front(), Catch::Contains("input 2 (current)") && Catch::Contains("is it connected?"));
}

TEST_CASE("A device is chosen by name, number or a part of its name", "[audio]")
{
    const std::vector<Device> devices {{"ALSA", "HDA Intel: ALC (hw:0,0)", 2, 2, {44100.0, 48000.0}, 4},
                                       {"JACK", "system", 18, 20, {96000.0}, 5},
                                       {"JACK", "Loudspeaker", 3, 1, {96000.0}, 6}};
    CHECK(chooseDevice(devices, "2").index == 5);
    CHECK(chooseDevice(devices, "JACK:system").index == 5);
    CHECK(chooseDevice(devices, "loud").index == 6);
    CHECK(chooseDevice(devices, "alsa").index == 4);
    refused(Error::Kind::usage,
            "There is no audio device '4'; there are 1 'ALSA:HDA Intel: ALC (hw:0,0)', 2 'JACK:system'",
            [&] { chooseDevice(devices, "4"); });
    refused(Error::Kind::usage, "More than one audio device is 'jack'", [&] { chooseDevice(devices, "jack"); });
    refused(Error::Kind::usage, "--device", [&] { chooseDevice(devices, ""); });
    refused(Error::Kind::input, "There is no audio device;", [&] { chooseDevice({}, "1"); });

    CHECK_NOTHROW(requireFit(devices[0], 2, 2, 48000.0, "plan"));
    refused(Error::Kind::usage, "Input 3 is mapped, but 'HDA Intel: ALC (hw:0,0)' has 2 inputs",
            [&] { requireFit(devices[0], 3, 1, 48000.0, "plan"); });
    refused(Error::Kind::usage, "Output 2 is to play, but 'Loudspeaker' has 1 output;",
            [&] { requireFit(devices[2], 3, 2, 96000.0, "plan"); });
    refused(Error::Kind::usage, "'plan' is for 32000 Hz, but 'HDA Intel: ALC (hw:0,0)' does only 44.1 and 48 kHz",
            [&] { requireFit(devices[0], 1, 1, 32000.0, "plan"); });
}
