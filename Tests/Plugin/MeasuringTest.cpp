// SPDX-License-Identifier: GPL-3.0-or-later
// The app measures a virtual loudspeaker on an audio device of its own.
#include "Engine/Take/TakeFile.h"
#include "Plugin/Clicks.h"
#include "Plugin/Editor.h"
#include "Plugin/VirtualDevice.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>
#include <thread>
#include <vector>

using namespace excursion;
using plugin::Editor;
using plugin::PageName;
using plugin::Processor;

namespace {

/// The app with the virtual loudspeaker on its device.
struct App {
    explicit App(const char* levels)
    {
        plugin::VirtualDevice::gone = plugin::VirtualDevice::scrambled = false;
        plugin::VirtualDevice::pace = 0.0;
        devices.addAudioDeviceType(std::make_unique<plugin::VirtualDeviceType>());
        devices.setCurrentAudioDeviceType("Virtual", true);
        juce::AudioDeviceManager::AudioDeviceSetup setup;
        setup.inputDeviceName = setup.outputDeviceName = "Virtual loudspeaker";
        setup.sampleRate = 48000.0;
        setup.bufferSize = 256;
        REQUIRE(devices.setAudioDeviceSetup(setup, true).isEmpty());
        processor.prepareToPlay(48000.0, 256);
        editor.emplace(processor, &devices);
        panel().setRole(2, Quantity::displacement, 8e-3);
        panel().setBand(20.0, 2000.0);
        panel().setLevels(levels);
    }

    plugin::MeasuringPanel& panel() { return *editor->measure().measuring(); }
    juce::String status() const { return editor->status(); }

    /// Until the measurement has ended, or what is waited for.
    void run(const std::function<bool()>& until = [] { return false; })
    {
        for (int k = 0; k < 4000 && panel().running() && !until(); ++k) {
            editor->update();
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
    }

    juce::AudioDeviceManager devices;
    Processor processor;
    std::optional<Editor> editor;
};

float peakOf(const std::vector<float>& samples, std::size_t from, std::size_t to)
{
    float peak = 0.0f;
    for (auto n = from; n < std::min(to, samples.size()); ++n)
        peak = std::max(peak, std::abs(samples[n]));
    return peak;
}

/// Where the last sound ends.
std::size_t endOf(const std::vector<float>& samples)
{
    auto end = samples.size();
    while (end > 0 && samples[end - 1] == 0.0f)
        --end;
    return end;
}

}  // namespace

TEST_CASE("A loudspeaker on an audio device is measured, and its hidden effect is found", "[plugin][slow]")
{
    App app("0.5 1.5 3.5");
    auto& editor = *app.editor;
    auto& processor = app.processor;
    auto& panel = app.panel();
    plugin::click(editor, "Start measuring");
    REQUIRE(panel.running());
    CHECK(processor.isSuspended());
    plugin::picture(editor, "measuring");
    editor.go(PageName::compare);  // it goes on, whatever page is seen
    app.run();
    REQUIRE(!panel.running());
    CHECK(!processor.isSuspended());
    plugin::settle(editor);
    plugin::picture(editor, "measured");
    const auto findings = processor.session().findings();
    REQUIRE(findings);
    for (const auto& problem : findings->report.problems)
        UNSCOPED_INFO(problem.sentence);
    REQUIRE(findings->report.fitForUse());
    REQUIRE(!findings->file.ladder.rungs.empty());
    CHECK(findings->file.ladder.verdict == Verdict::missingEffect);
    CHECK(findings->file.ladder.rungs[0].diagnosis.ranking[0].effect == "stiffness");

    SECTION("its model is linearized at the volts that the output was measured with")
    {
        CHECK(findings->fullScale == 16.0);
        auto& parameters = processor.parameters();
        REQUIRE(parameters.settings().fullScale == 10.0);
        editor.go(PageName::diagnose);
        editor.update();
        plugin::click(editor, "Linearize with this model");
        CHECK(parameters.settings().fullScale == 16.0);
        CHECK(parameters.settings().mode == Mode::linearize);
        editor.undo();
        CHECK(parameters.settings().mode == Mode::bypass);
        CHECK(parameters.settings().fullScale == 16.0);
        editor.undo();
        CHECK(parameters.settings().fullScale == 10.0);
        editor.redo();
        CHECK(parameters.settings().fullScale == 16.0);
    }
    SECTION("a take that is in no file is not given up unasked")
    {
        auto& session = processor.session();
        CHECK(session.unsaved(false) == "the take that was measured");
        editor.go(PageName::measure);
        plugin::click(editor, "Measure it");
        plugin::answer(editor, false);
        CHECK(!session.status().busy);
        editor.load(juce::File("/nowhere/take.csv"));  // as if it had been dropped
        plugin::answer(editor, false);
        CHECK(session.status().failures == 0);
        plugin::click(editor, "Start measuring");
        plugin::picture(editor, "asked");
        plugin::answer(editor, false);
        CHECK(!panel.running());
        CHECK(session.findings() == findings);

        const auto folder = juce::File::createTempFile("saved");
        editor.measure().saveTake(findings, folder);
        session.wait();
        CHECK(session.unsaved(true).empty());
        folder.deleteRecursively();
        plugin::click(editor, "Measure it");
        CHECK(plugin::question(editor) == nullptr);
        CHECK(session.status().busy);
        session.cancel();
        session.wait();
    }
    SECTION("a channel is played where it is among those that are open")
    {
        const auto first = processor.session().findings();
        struct Outputs {
            Outputs() { plugin::VirtualDevice::firstOutput = 2; }
            ~Outputs() { plugin::VirtualDevice::firstOutput = 0; }
        } const outputs;
        editor.go(PageName::measure);
        panel.setOutput(3);
        plugin::click(editor, "Start measuring");
        plugin::answer(editor, true);
        CHECK(panel.running());
        app.run();
        REQUIRE(!panel.running());
        plugin::settle(editor);
        REQUIRE(processor.session().findings() != first);
        CHECK(processor.session().findings()->report.fitForUse());
    }
    SECTION("a device that is gone without a word ends the measurement")
    {
        editor.go(PageName::measure);
        plugin::click(editor, "Start measuring");
        plugin::answer(editor, true);
        REQUIRE(panel.running());
        plugin::VirtualDevice::gone = true;
        app.run();
        plugin::VirtualDevice::gone = false;
        CHECK(!panel.running());
        CHECK(!processor.isSuspended());
        CHECK(editor.status().contains("no sound any more"));
    }
    SECTION("a take is not written over another")
    {
        const auto folder = juce::File::createTempFile("take");
        REQUIRE(folder.createDirectory());
        REQUIRE(folder.getChildFile("measurement.json").replaceWithText("mine"));
        editor.measure().saveTake(processor.session().findings(), folder);
        editor.update();
        CHECK(editor.status().contains("holds a take or a recording already"));
        processor.session().wait();
        CHECK(folder.getChildFile("measurement.json").loadFileAsString() == "mine");
        folder.deleteRecursively();
    }
    SECTION("what makes no sense is refused in a sentence")
    {
        editor.go(PageName::measure);
        panel.setLevels("0.5 loud");
        plugin::click(editor, "Start measuring");
        CHECK(!panel.running());
        CHECK(editor.status().contains("loud"));
        panel.setLevels("9");
        plugin::click(editor, "Start measuring");
        CHECK(!panel.running());
        panel.setLevels("0.5 1,5");
        plugin::click(editor, "Start measuring");
        CHECK(!panel.running());
        CHECK(editor.status().contains("1,5"));
        panel.setOutput(5);
        panel.setLevels("0.5 1");
        plugin::click(editor, "Start measuring");
        CHECK(!panel.running());
        CHECK(editor.status().contains("Output 5 is not open"));
        panel.setOutput(1);
        panel.setLevels("1");
        panel.setRole(2, Quantity::current, 1.0);
        plugin::click(editor, "Start measuring");
        CHECK(!panel.running());
        CHECK(editor.status().contains("current"));
    }
}

TEST_CASE("The level of a measurement rises by itself, and Stop fades out", "[plugin][slow]")
{
    App app("1 3");
    plugin::VirtualDevice::takePlayed();
    plugin::VirtualDevice::pace = 8.0;
    plugin::click(*app.editor, "Start measuring");
    CHECK(plugin::find<juce::TextButton>(*app.editor, "Audio device...")->isEnabled() == false);
    app.run([&] { return app.panel().fraction() > 0.7; });
    plugin::click(*app.editor, "Stop");
    app.run();
    CHECK(!app.panel().running());
    CHECK(!app.processor.isSuspended());
    CHECK(app.status().contains("stopped"));
    CHECK(!app.processor.session().findings());
    const auto played = plugin::VirtualDevice::takePlayed();
    const auto end = endOf(played);
    const auto begin = static_cast<std::size_t>(
        std::find_if(played.begin(), played.end(), [](float s) { return s != 0.0f; }) - played.begin());
    REQUIRE(end > begin + 4 * 48000);
    const float full = peakOf(played, begin, end);
    CHECK(peakOf(played, begin, begin + 24000) < 0.1f * full);
    CHECK(peakOf(played, begin, begin + 2 * 48000) < 0.4f * full);
    CHECK(peakOf(played, end - 100, end) < 0.1f * peakOf(played, end - 8000, end - 2000));
}

TEST_CASE("Stop ends a measurement on a device that hangs", "[plugin][slow]")
{
    App app("1");
    plugin::VirtualDevice::pace = 4.0;
    plugin::click(*app.editor, "Start measuring");
    app.run([&] { return app.panel().fraction() > 0.3; });
    REQUIRE(app.panel().running());
    plugin::VirtualDevice::gone = true;
    const auto before = std::chrono::steady_clock::now();
    plugin::click(*app.editor, "Stop");
    app.run();
    plugin::VirtualDevice::gone = false;
    CHECK(!app.panel().running());
    CHECK(std::chrono::steady_clock::now() - before < std::chrono::seconds(3));
    CHECK(!app.processor.isSuspended());
    CHECK(app.status().contains("answers no longer"));
    CHECK(!app.processor.session().findings());
    CHECK(app.processor.session().unsaved(true).empty());
}

TEST_CASE("A limit ends a measurement of the app, and nothing is taken of it", "[plugin][slow]")
{
    App app("1 3");
    app.panel().setLimit(2, "0.15mm");
    plugin::VirtualDevice::takePlayed();
    plugin::click(*app.editor, "Start measuring");
    app.run();
    CHECK(app.status().contains("The displacement reached"));
    CHECK(app.status().contains("limit of 0.00015 m"));
    CHECK(!app.processor.session().status().busy);
    CHECK(!app.processor.session().findings());
    CHECK(!app.processor.isSuspended());
    const auto played = plugin::VirtualDevice::takePlayed();
    CHECK(static_cast<double>(peakOf(played, 0, played.size())) < 0.5 * 4.0 * 3.0 / 16.0);
    app.panel().setLimit(2, "4");  // which is metres
    plugin::click(*app.editor, "Start measuring");
    CHECK(!app.panel().running());
    CHECK(!app.processor.isSuspended());
    CHECK(app.status().contains("cannot reach"));
    app.panel().setLimit(2, "much");
    plugin::click(*app.editor, "Start measuring");
    CHECK(!app.panel().running());
    CHECK(app.status().contains("much"));
}

TEST_CASE("Where a device loses samples the plan is played again, and the take says so", "[plugin][slow]")
{
    App app("1");
    plugin::VirtualDevice::takePlayed();
    plugin::VirtualDevice::losesAt = 6 * 48000;  // amid the plan
    plugin::click(*app.editor, "Start measuring");
    app.run();
    plugin::settle(*app.editor);
    const auto findings = app.processor.session().findings();
    REQUIRE(findings);
    CHECK(findings->report.fitForUse());
    REQUIRE(!findings->remarks.empty());
    CHECK(juce::String(findings->remarks.front()).contains("played again"));
    // 6 s of the first attempt and all of the plan; no second rise, as the first one was completed
    const auto played = plugin::VirtualDevice::takePlayed();
    CHECK(endOf(played) > 9 * 48000);
    CHECK(endOf(played) < 13 * 48000);
}

TEST_CASE("A recording that is no take can be saved", "[plugin][slow]")
{
    App app("1");
    plugin::VirtualDevice::scrambled = true;
    plugin::click(*app.editor, "Start measuring");
    app.run();
    plugin::VirtualDevice::scrambled = false;
    auto& session = app.processor.session();
    session.wait();
    app.editor->update();
    REQUIRE(session.status().trouble);
    CHECK(app.status().contains("Save the recording"));
    const auto recording = session.recordingWithoutTake();
    REQUIRE(recording);
    // Another take, which is fit for use, leaves it where it is.
    session.open(plugin::VirtualOrder {"midbass", 3});
    for (int k = 0; k < 60000 && !session.findings(); ++k)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    REQUIRE(session.findings());
    CHECK(session.findings()->report.fitForUse());
    session.cancel();
    session.wait();
    app.editor->update();
    CHECK(session.recordingWithoutTake() == recording);
    CHECK(session.unsaved(false).empty());
    CHECK(session.unsaved(true) == "the last recording");
    CHECK(plugin::find<juce::TextButton>(*app.editor, "Save the take...")->isEnabled());
    REQUIRE(plugin::find<juce::TextButton>(*app.editor, "Save the recording...") != nullptr);
    const auto folder = juce::File::createTempFile("refused");
    app.editor->measure().saveRecording(recording, folder);
    session.wait();
    const auto place = std::filesystem::path(folder.getFullPathName().toStdString());
    CHECK(readWav(place / "recording.wav").channels.size() == 3);
    CHECK(readOwnTake(headerOf(place / "plan")).take.input().samples.size() == recording->plan->input().samples.size());
    CHECK(!session.recordingWithoutTake());
    CHECK(juce::File(folder.getChildFile("import.txt")).loadFileAsString().contains("--map 2=current:4"));
    app.editor->update();
    app.editor->measure().saveRecording(recording, folder);
    app.editor->update();
    CHECK(app.status().contains("holds a take or a recording already"));
    folder.deleteRecursively();
}

TEST_CASE("What was measured waits for the work that is under way, whatever else is opened or saved", "[plugin][slow]")
{
    App app("1");
    auto& session = app.processor.session();
    plugin::click(*app.editor, "Start measuring");
    session.open(plugin::VirtualOrder {"midbass", 3});
    app.run();
    app.editor->update();
    REQUIRE(session.keeps());
    plugin::click(*app.editor, "Start measuring");
    CHECK(!app.panel().running());
    CHECK(app.status().contains("waits"));
    const auto folder = juce::File::createTempFile("waiting");
    session.saveRecording(session.recordingWithoutTake(), folder.getFullPathName().toStdString());
    session.wait();
    CHECK(folder.getChildFile("recording.wav").existsAsFile());
    REQUIRE(session.keeps());
    app.editor->update();  // it is opened
    CHECK(!session.keeps());
    plugin::settle(*app.editor);
    REQUIRE(session.findings());
    CHECK(juce::String(session.findings()->source).contains("Measured with Virtual loudspeaker"));
    CHECK(!session.recordingWithoutTake());
    folder.deleteRecursively();
}
