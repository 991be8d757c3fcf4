// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Editor.h"
#include "Plugin/Played.h"
#include "Plugin/Processor.h"

#include "Engine/Loudspeaker/Catalogue.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <cmath>
#include <numbers>
#include <random>
#include <thread>

using namespace excursion;
using namespace excursion::test;
using plugin::Processor;

namespace {

/// Plays a signal through, on every channel, without its latency.
std::vector<float> played(Processor& processor, const std::vector<float>& u, int block, int channels = 2)
{
    auto in = u;
    in.resize(u.size() + static_cast<std::size_t>(processor.getLatencySamples()), 0.0f);
    std::vector<float> out;
    juce::MidiBuffer midi;
    for (std::size_t n = 0; n < in.size();) {
        const int count = static_cast<int>(std::min<std::size_t>(static_cast<std::size_t>(block), in.size() - n));
        juce::AudioBuffer<float> buffer(channels, count);
        for (int c = 0; c < channels; ++c)
            buffer.copyFrom(c, 0, in.data() + n, count);
        processor.processBlock(buffer, midi);
        out.insert(out.end(), buffer.getReadPointer(channels - 1), buffer.getReadPointer(channels - 1) + count);
        n += static_cast<std::size_t>(count);
    }
    out.erase(out.begin(), out.begin() + processor.getLatencySamples());
    return out;
}

std::vector<float> tone(double sampleRate, double seconds, double amplitude)
{
    std::vector<float> u(static_cast<std::size_t>(sampleRate * seconds));
    for (std::size_t n = 0; n < u.size(); ++n) {
        const double t = static_cast<double>(n) / sampleRate;
        u[n] = static_cast<float>(amplitude * std::sin(2.0 * std::numbers::pi * 60.0 * t) * std::min(1.0, 20.0 * t));
    }
    return u;
}

double distance(const std::vector<float>& a, const std::vector<float>& b)
{
    double worst = 0.0;
    for (std::size_t n = 0; n < std::min(a.size(), b.size()); ++n)
        worst = std::max(worst, std::abs(static_cast<double>(a[n]) - static_cast<double>(b[n])));
    return worst;
}

void setMode(Processor& processor, Mode mode) { processor.parameters().mode() = static_cast<int>(mode); }

void layout(Processor& processor, int channels)
{
    const auto set = channels == 1 ? juce::AudioChannelSet::mono() : juce::AudioChannelSet::stereo();
    juce::AudioProcessor::BusesLayout buses;
    buses.inputBuses.add(set);
    buses.outputBuses.add(set);
    REQUIRE(processor.setBusesLayout(buses));
}

}  // namespace

TEST_CASE("Every mode does what the engine's chain does, at every rate, in mono and stereo", "[plugin]")
{
    for (const double rate : {44100.0, 48000.0, 96000.0})
        for (const int channels : {1, 2})
            for (const auto mode : modes) {
                INFO(rate << " Hz, " << channels << " channels, " << name(mode));
                Processor processor;
                layout(processor, channels);
                setMode(processor, mode);
                processor.prepareToPlay(rate, 512);
                const auto u = tone(rate, 0.15, 0.4);
                const auto out = played(processor, u, 512, channels);
                Chain chain(processor.model(), {rate, Processor::oversampling},
                            processor.parameters().controls(measuredDisplacement(processor.model())));
                CHECK(chain.latency() == processor.getLatencySamples());
                std::vector<double> expected(u.begin(), u.end());
                expected.resize(u.size() + static_cast<std::size_t>(chain.latency()), 0.0);
                chain.process(expected.data(), expected.data(), expected.size());
                std::vector<float> rounded(expected.begin() + chain.latency(), expected.end());
                CHECK(distance(out, rounded) < 1e-7);
                if (mode == Mode::bypass)
                    CHECK(distance(out, u) < 1e-7);
            }
}

TEST_CASE("Blocks from 1 to 8192 samples, larger ones than announced included, give the same", "[plugin]")
{
    const auto u = tone(48000.0, 0.3, 0.4);
    const auto play = [&u](int block) {
        Processor processor;
        setMode(processor, Mode::audition);
        processor.prepareToPlay(48000.0, 64);
        return played(processor, u, block);
    };
    const auto expected = play(64);
    for (const int block : {1, 7, 500, 8192})
        CHECK(play(block) == expected);
}

TEST_CASE("The host's bypass is the signal as it was, as late as ever", "[plugin]")
{
    Processor processor;
    setMode(processor, Mode::speaker);
    processor.prepareToPlay(48000.0, 512);
    const auto u = tone(48000.0, 0.5, 0.4);
    const auto latency = static_cast<std::size_t>(processor.getLatencySamples());
    const auto out = playedInBlocks(
        u, [&](auto& buffer, auto& midi) { processor.processBlockBypassed(buffer, midi); }, [](std::size_t) {});
    double worst = 0.0;  // once the mode has been faded out
    for (std::size_t n = 4800; n < out.size(); ++n)
        worst = std::max(worst, std::abs(static_cast<double>(out[n] - u[n - latency])));
    CHECK(worst < 1e-6);
}

TEST_CASE("The state is byte for byte the same when it is saved twice, and when it has been restored", "[plugin]")
{
    Processor processor;
    const auto& drivers = plugin::factoryDrivers();
    REQUIRE(drivers.size() >= 6);
    REQUIRE(plugin::factoryRecipes().size() >= 3);
    processor.setModel(plugin::modelFromText(drivers.front().text, "a driver"));
    std::mt19937 random(4);
    for (int round = 0; round < 20; ++round) {
        for (auto* parameter : processor.getParameters())
            parameter->setValueNotifyingHost(static_cast<float>(random() % 10001) / 10000.0f);
        const auto state = stateOf(processor);
        CHECK(stateOf(processor) == state);
        Processor other;
        other.setStateInformation(state.getData(), static_cast<int>(state.getSize()));
        CHECK(stateOf(other) == state);
        CHECK(other.model().name == drivers.front().title);
        CHECK(other.parameters().recipe().mode == processor.parameters().recipe().mode);
    }
}

TEST_CASE("A state that cannot be used changes nothing, and goes back to the host until something is changed",
          "[plugin]")
{
    Processor processor;
    auto recipe = plugin::recipeFromText(plugin::factoryRecipes().front().text, "a recipe");
    processor.parameters().set(recipe);
    const auto state = stateOf(processor);
    auto text = state.toString().toStdString();
    auto later = text;
    later.replace(later.find("\"version\": 1"), 12, "\"version\": 9");
    const auto now = [&] { return toJson(processor.parameters().recipe()).dump(); };
    const auto kept = now();
    const auto version = processor.modelVersion();
    CHECK(processor.refusal().empty());
    for (const auto& broken :
         {std::string("{"), std::string("[]"), std::string(1000, '\0'), text.substr(0, text.size() / 2), later}) {
        processor.setStateInformation(broken.data(), static_cast<int>(broken.size()));
        CHECK(now() == kept);
        CHECK(processor.modelVersion() == version);
        // A host that saves now would otherwise write over the only copy.
        CHECK((stateOf(processor) == juce::MemoryBlock(broken.data(), broken.size())));
        CHECK((stateOf(processor) == juce::MemoryBlock(broken.data(), broken.size())));
        CHECK(juce::String(processor.refusal()).startsWith("What was saved is not used: "));
    }
    CHECK(juce::String(processor.refusal()).contains("version"));
    plugin::Editor editor(processor);
    editor.update();
    CHECK(editor.status() == juce::String(processor.refusal()));
    for (const auto size : {0, 1}) {  // nothing that could be lost
        processor.setStateInformation(size == 0 ? text.data() : nullptr, size);
        CHECK((stateOf(processor) == juce::MemoryBlock(later.data(), later.size())));
    }
    SECTION("a parameter")
    {
        recipe.amount = 0.5;
        processor.parameters().set(recipe);
        CHECK(stateOf(processor).toString().contains("0.5"));
    }
    SECTION("a model") { processor.setModel(plugin::modelFromText(plugin::factoryDrivers().back().text, "a driver")); }
    SECTION("a state that can be used")
    {
        processor.setStateInformation(state.getData(), static_cast<int>(state.getSize()));
        CHECK((stateOf(processor) == state));
    }
    CHECK((stateOf(processor) != juce::MemoryBlock(later.data(), later.size())));
    CHECK(processor.refusal().empty());
}

TEST_CASE("A recipe reaches the parameters and comes back as it was", "[plugin]")
{
    Processor processor;
    for (const auto& factory : plugin::factoryRecipes()) {
        auto recipe = plugin::recipeFromText(factory.text, factory.title);
        recipe.off = {"creep"};
        processor.parameters().set(recipe);
        CHECK(toJson(processor.parameters().recipe()).dump() == toJson(recipe).dump());
    }
}

TEST_CASE("An amplifier that is stated while audio runs takes off what its high-pass does, without a step", "[plugin]")
{
    Processor processor;
    setMode(processor, Mode::speaker);
    processor.setNonRealtime(true);  // new chains come with the next block
    processor.prepareToPlay(48000.0, 480);
    constexpr double corner = 20.0, frequency = 10.0;
    std::vector<float> u(3 * 48000);
    for (std::size_t n = 0; n < u.size(); ++n)
        u[n] = static_cast<float>(0.02
                                  * std::sin(2.0 * std::numbers::pi * frequency * static_cast<double>(n) / 48000.0));
    auto& numbers = processor.parameters();
    const auto meanwhile = [&](std::size_t n) {
        if (n == 48000)
            for (auto* number : numbers.numbers())
                if (number->paramID == "coupling")
                    number->set(corner);
        if (n == 96000)
            numbers.couplingOrder() = 1;
    };
    const auto out = playedInBlocks(
        u, [&](auto& buffer, auto& midi) { processor.processBlock(buffer, midi); }, meanwhile);
    const auto level = [&](std::size_t from) {
        double power = 0.0;
        for (std::size_t n = from; n < from + 9600; ++n)
            power += static_cast<double>(out[n]) * static_cast<double>(out[n]);
        return 10.0 * std::log10(power);
    };
    REQUIRE(numbers.settings().coupling == corner);
    const double ratio = std::pow(frequency / corner, 2);
    CHECK(level(84000) - level(36000) == Approx(10.0 * std::log10(ratio / (1.0 + ratio))).margin(0.2));
    CHECK(level(132000) - level(36000) == Approx(10.0 * std::log10(ratio * ratio / (1.0 + ratio * ratio))).margin(0.2));
    double steepest = 0.0, peak = 0.0;
    for (std::size_t n = 1; n < out.size(); ++n) {
        steepest = std::max(steepest, std::abs(static_cast<double>(out[n] - out[n - 1])));
        peak = std::max(peak, std::abs(static_cast<double>(out[n])));
    }
    CHECK(steepest < 0.02 * peak);
}

TEST_CASE("An effect is switched off while audio runs, and a model replaced, without a step", "[plugin]")
{
    Processor processor;
    setMode(processor, Mode::speaker);
    processor.prepareToPlay(48000.0, 480);
    const auto u = tone(48000.0, 4.0, 0.5);
    const auto meanwhile = [&](std::size_t n) {
        if (n == 48000)
            *processor.parameters().effects()[1] = false;
        if (n == 96000)
            processor.setModel(plugin::modelFromText(plugin::factoryDrivers().back().text, "a driver"));
        std::this_thread::sleep_for(std::chrono::milliseconds(1));  // the thread that builds has its time
    };
    const auto out = playedInBlocks(
        u, [&](auto& buffer, auto& midi) { processor.processBlock(buffer, midi); }, meanwhile);
    double steepest = 0.0;
    for (std::size_t n = 1; n < out.size(); ++n)
        steepest = std::max(steepest, std::abs(static_cast<double>(out[n] - out[n - 1])));
    CHECK(steepest < 0.05);
    const auto period = [&](std::size_t from) {
        return std::vector<float>(out.begin() + static_cast<std::ptrdiff_t>(from),
                                  out.begin() + static_cast<std::ptrdiff_t>(from + 800));
    };
    CHECK(distance(period(47200), period(95200)) > 1e-4);   // the effect is gone
    CHECK(distance(period(95200), period(180000)) > 1e-2);  // another driver
}
