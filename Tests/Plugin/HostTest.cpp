// SPDX-License-Identifier: GPL-3.0-or-later
// What hosts do besides playing: states that come late, resets, renders, and listeners that ask at once.
#include "Played.h"

#include "Plugin/Editor.h"
#include "Plugin/Walk.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <thread>

using namespace excursion;
using excursion::test::playedInBlocks;
using excursion::test::stateOf;
using plugin::Editor;
using plugin::Processor;

namespace {

constexpr double rate = 48000.0;

std::vector<float> tone(double frequency, double seconds, double amplitude)
{
    std::vector<float> u(static_cast<std::size_t>(rate * seconds));
    for (std::size_t n = 0; n < u.size(); ++n)
        u[n] = static_cast<float>(amplitude
                                  * std::sin(2.0 * std::numbers::pi * frequency * static_cast<double>(n) / rate));
    return u;
}

std::vector<float> heard(
    Processor& processor, const std::vector<float>& u,
    const std::function<void(std::size_t)>& after = [](std::size_t) {})
{
    return playedInBlocks(
        u, [&](auto& buffer, auto& midi) { processor.processBlock(buffer, midi); }, after);
}

void wants(Processor& processor, Mode mode, double voltageLimit = 1000.0)
{
    auto recipe = processor.parameters().recipe();
    recipe.mode = mode;
    recipe.voltageLimit = voltageLimit;
    processor.parameters().set(recipe);
}

float loudest(const std::vector<float>& u)
{
    float most = 0.0f;
    for (const float value : u)
        most = std::max(most, std::abs(value));
    return most;
}

/// Counts what a host is told.
struct Listener : juce::AudioProcessorListener {
    std::function<void(int)> moved;
    int states = 0;

    void audioProcessorParameterChanged(juce::AudioProcessor*, int index, float) override
    {
        if (moved)
            moved(index);
    }
    void audioProcessorChanged(juce::AudioProcessor*, const ChangeDetails& details) override
    {
        states += details.nonParameterStateChanged ? 1 : 0;
    }
};

}  // namespace

TEST_CASE("A state counts from the first sample on, whether it comes before or after the rate", "[plugin]")
{
    Processor saved;
    saved.setModel(plugin::modelFromText(plugin::factoryDrivers().front().text, "a driver"));
    wants(saved, Mode::speaker);
    const auto state = stateOf(saved);
    const auto restore = [&](Processor& processor) {
        processor.setStateInformation(state.getData(), static_cast<int>(state.getSize()));
    };
    const auto u = tone(60.0, 0.3, 0.5);
    Processor early, late;
    restore(early);
    early.prepareToPlay(rate, 480);
    late.prepareToPlay(rate, 480);
    heard(late, {});
    juce::AudioBuffer<float> none(2, 0);  // as hosts bring parameters
    juce::MidiBuffer midi;
    late.processBlock(none, midi);
    restore(late);
    CHECK(late.getLatencySamples() == early.getLatencySamples());
    const auto expected = heard(early, u);
    CHECK(heard(late, u) == expected);
    CHECK(loudest(expected) > 0.1f);
    // After a reset as well, whatever was going on: here a mode and a model that are being faded to.
    Processor reset;
    reset.prepareToPlay(rate, 480);
    heard(reset, u);
    restore(reset);
    heard(reset, tone(200.0, 0.01, 0.9));
    reset.setNonRealtime(true);  // else the coil is as warm as it was
    reset.reset();
    CHECK(heard(reset, u) == expected);
}

TEST_CASE("A render does not depend on when the thread that builds finds time", "[plugin]")
{
    const auto u = tone(60.0, 1.0, 0.8);
    const auto rendered = [&](bool switches) {
        Processor processor;
        wants(processor, Mode::speaker);
        processor.setNonRealtime(true);
        if (!switches)
            *processor.parameters().effects()[1] = false;
        processor.prepareToPlay(rate, 480);
        return heard(processor, u, [&](std::size_t n) {
            if (switches && n == 9600)
                *processor.parameters().effects()[1] = false;
        });
    };
    const auto once = rendered(true);
    CHECK(rendered(true) == once);
    const auto without = rendered(false);
    double apart = 0.0;
    for (std::size_t n = 24000; n < u.size(); ++n)
        apart = std::max(apart, std::abs(static_cast<double>(once[n]) - static_cast<double>(without[n])));
    CHECK(apart < 1e-4);
    CHECK(once != without);
}

TEST_CASE("A render goes on while models and switches are changed", "[plugin]")
{
    // As wrappers do, with the host's lock held: whoever builds must not wait for that with a lock of its own.
    Processor processor;
    wants(processor, Mode::speaker);
    processor.setNonRealtime(true);
    processor.prepareToPlay(rate, 480);
    std::atomic<bool> finite {true};
    std::atomic<int> blocks {0};
    std::jthread rendering([&](const std::stop_token& stop) {
        juce::AudioBuffer<float> buffer(2, 480);
        juce::MidiBuffer midi;
        while (!stop.stop_requested()) {
            const juce::ScopedLock host(processor.getCallbackLock());
            for (int c = 0; c < 2; ++c)
                buffer.copyFrom(c, 0, tone(60.0, 0.01, 0.5).data(), 480);
            processor.processBlock(buffer, midi);
            finite = finite && std::isfinite(buffer.getSample(0, 479));
            ++blocks;
        }
    });
    for (int round = 0; round < 6; ++round) {
        const auto& drivers = plugin::factoryDrivers();
        processor.setModel(
            plugin::modelFromText(drivers[static_cast<std::size_t>(round) % drivers.size()].text, "a driver"));
        *processor.parameters().effects()[static_cast<std::size_t>(round)] = false;
        const int before = blocks;
        while (blocks < before + 5)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    CHECK(finite);
    // And a render begins cold, whatever was played before it.
    rendering.request_stop();
    rendering.join();
    const auto u = tone(60.0, 0.2, 0.9);
    const auto state = stateOf(processor);
    const auto rendered = [&](bool playsBefore) {
        Processor other;
        other.setStateInformation(state.getData(), static_cast<int>(state.getSize()));
        other.prepareToPlay(rate, 480);
        if (playsBefore)
            heard(other, tone(130.0, 0.25, 0.7));
        other.setNonRealtime(true);
        return heard(other, u);
    };
    CHECK(rendered(true) == rendered(false));
}

TEST_CASE("A coil stays as warm as it is through a reset and another preparation", "[plugin]")
{
    const auto u = tone(200.0, 0.3, 1.0);
    const auto loudnessOf = [&](const std::function<void(Processor&)>& between) {
        Processor processor;
        auto recipe = processor.parameters().recipe();
        recipe.mode = Mode::linearize;
        recipe.fullScale = 20.0;
        recipe.displacementLimit = 4.0;
        recipe.powerLimit = 1.0;
        processor.parameters().set(recipe);
        processor.prepareToPlay(rate, 480);
        double sum = 0.0;
        for (int k = 0; k < 12; ++k) {
            const auto out = heard(processor, u);
            if (k >= 6)  // the first second may be louder
                for (const float value : out)
                    sum += static_cast<double>(value) * static_cast<double>(value);
            between(processor);
        }
        return sum;
    };
    const double through = loudnessOf([](Processor&) {});
    CHECK(loudnessOf([](Processor& p) { p.reset(); }) < 1.05 * through);
    CHECK(loudnessOf([](Processor& p) { p.prepareToPlay(rate, 480); }) < 1.05 * through);
}

TEST_CASE("A recipe takes effect as a whole", "[plugin]")
{
    Processor processor;
    auto recipe = processor.parameters().recipe();
    recipe.fullScale = 40.0;
    recipe.displacementLimit = 4.0;
    recipe.voltageLimit = 1000.0;
    processor.parameters().set(recipe);
    processor.prepareToPlay(rate, 480);
    const auto u = tone(200.0, 0.3, 0.9);
    heard(processor, u);
    Listener host;
    std::vector<float> meanwhile;
    host.moved = [&](int) {
        const auto some = heard(processor, tone(200.0, 0.05, 0.9));
        meanwhile.insert(meanwhile.end(), some.begin(), some.end());
    };
    processor.addListener(&host);
    recipe.mode = Mode::linearize;
    recipe.voltageLimit = 2.0;
    processor.parameters().set(recipe);
    host.moved = {};
    processor.removeListener(&host);
    CHECK(!meanwhile.empty());
    const auto latency = processor.getLatencySamples();
    // All of it is there before the host is told of any part.
    CHECK(40.0f * loudest({meanwhile.begin() + latency, meanwhile.end()}) < 2.001f);
    const auto out = heard(processor, u);
    CHECK(40.0f * loudest({out.begin() + latency, out.end()}) < 2.001f);
}

TEST_CASE("A recipe that a person chooses is a gesture for each parameter that it changes, a state is none", "[plugin]")
{
    // b, c and e of each parameter: a gesture begins, the value changes, the gesture ends
    struct Gestures : juce::AudioProcessorListener {
        explicit Gestures(Processor& of) : processor(of) { processor.addListener(this); }
        ~Gestures() override { processor.removeListener(this); }
        void audioProcessorParameterChanged(juce::AudioProcessor*, int index, float) override { heard[index] += "c"; }
        void audioProcessorChanged(juce::AudioProcessor*, const ChangeDetails&) override {}
        void audioProcessorParameterChangeGestureBegin(juce::AudioProcessor*, int index) override
        {
            heard[index] += "b";
        }
        void audioProcessorParameterChangeGestureEnd(juce::AudioProcessor*, int index) override { heard[index] += "e"; }
        Processor& processor;
        std::map<int, std::string> heard;
    };
    Processor processor;
    Editor editor(processor);
    editor.go(plugin::PageName::linearize);
    editor.update();
    const auto values = [&] {
        std::vector<float> all;
        for (auto* parameter : processor.getParameters())
            all.push_back(parameter->getValue());
        return all;
    };
    const auto asGestures = [&](const std::function<void()>& act) {
        Gestures gestures(processor);
        const auto before = values();
        act();
        const auto now = values();
        CHECK(before != now);
        for (std::size_t k = 0; k < now.size(); ++k) {
            INFO(processor.getParameters()[static_cast<int>(k)]->getName(40));
            CHECK(gestures.heard[static_cast<int>(k)] == (now[k] != before[k] ? "bce" : ""));
        }
    };
    const auto fresh = stateOf(processor);
    for (auto* list : plugin::all<juce::ComboBox>(editor.page(plugin::PageName::linearize)))
        if (list->getTitle() == "Recipes")
            asGestures([&] { list->setSelectedItemIndex(1, juce::sendNotificationSync); });
    asGestures([&] { editor.undo(); });
    asGestures([&] { editor.redo(); });
    Gestures gestures(processor);
    processor.setStateInformation(fresh.getData(), static_cast<int>(fresh.getSize()));
    CHECK((stateOf(processor) == fresh));
    for (const auto& [index, heard] : gestures.heard) {
        INFO(processor.getParameters()[index]->getName(40));
        CHECK(heard.find_first_of("be") == std::string::npos);
    }
}

TEST_CASE("A host is told that there is something to save that no parameter shows", "[plugin]")
{
    Processor processor;
    processor.prepareToPlay(rate, 480);
    Editor editor(processor);
    Listener host;
    processor.addListener(&host);
    const auto& drivers = plugin::factoryDrivers();
    editor.use(plugin::modelFromText(drivers.front().text, "a driver"), "a test");
    CHECK(host.states == 1);
    editor.undo();
    CHECK(host.states == 2);
    const auto state = stateOf(processor);
    processor.setStateInformation(state.getData(), static_cast<int>(state.getSize()));
    CHECK(host.states == 2);  // else every project that is opened has changed
    processor.removeListener(&host);
}

TEST_CASE("A file that says nonsense of its format is told, and nothing else happens", "[plugin]")
{
    Processor processor;
    Editor editor(processor);
    const juce::TemporaryFile file("x.json");
    for (const char* text :
         {R"({"format": 7})", R"({"format": null})", R"({"format": {"a": 1}})", "{}", "[]", "7", ""}) {
        CAPTURE(text);
        REQUIRE(file.getFile().replaceWithText(text));
        const auto before = processor.modelVersion();
        CHECK_NOTHROW(editor.load(file.getFile()));
        CHECK(processor.modelVersion() == before);
    }
}

TEST_CASE("A driver whose model tells no range has no limit of the excursion, and does not seem to", "[plugin]")
{
    const auto driver = plugin::modelFromText(plugin::factoryDrivers().front().text, "a driver");
    CHECK(plugin::limitsExcursion(driver));
    CHECK_FALSE(plugin::limitsExcursion(linearPart(driver)));
}
