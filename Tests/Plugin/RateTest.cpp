// SPDX-License-Identifier: GPL-3.0-or-later
// A host may prepare the plugin for anything.
#include "Engine/Error.h"
#include "Plugin/Editor.h"
#include "Plugin/Played.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

using namespace excursion;
using namespace excursion::test;
using plugin::Editor;
using plugin::Processor;

namespace {

std::vector<float> noise(std::size_t n)
{
    std::mt19937 random(5);
    std::vector<float> u(n);
    for (auto& sample : u)
        sample = static_cast<float>(random() % 2001) / 1000.0f - 1.0f;
    return u;
}

/// What comes out of both channels when the signal goes in, in blocks of changing length.
template <class Sample>
std::vector<float> played(Processor& processor, const std::vector<float>& u, int channel, bool bypassed = false)
{
    std::vector<float> out;
    juce::MidiBuffer midi;
    for (std::size_t n = 0, block = 1; n < u.size(); n += block, block = block % 700 + 13) {
        const auto count = static_cast<int>(std::min(block, u.size() - n));
        juce::AudioBuffer<Sample> buffer(2, count);
        for (int k = 0; k < count; ++k)
            for (int c = 0; c < 2; ++c)
                buffer.setSample(c, k, static_cast<Sample>(u[n + static_cast<std::size_t>(k)]));
        bypassed ? processor.processBlockBypassed(buffer, midi) : processor.processBlock(buffer, midi);
        for (int k = 0; k < count; ++k)
            out.push_back(static_cast<float>(buffer.getSample(channel, k)));
    }
    return out;
}

/// Whether the second is the first, so many samples later.
bool isLate(const std::vector<float>& u, const std::vector<float>& out, int latency)
{
    for (std::size_t n = 0; n < out.size(); ++n)
        if (const auto late = static_cast<std::size_t>(latency); out[n] != (n < late ? 0.0f : u[n - late]))
            return false;
    return true;
}

constexpr double noNumber = std::numeric_limits<double>::quiet_NaN(),
                 infinite = std::numeric_limits<double>::infinity();

}  // namespace

TEST_CASE(
    "At a rate at which the engine cannot run the signal goes through as it is, in every mode, as late as is reported",
    "[plugin]")
{
    const auto u = noise(3000);
    Processor processor;
    const int latency = processor.getLatencySamples();
    REQUIRE(latency > 0);
    for (const double rate : {1.0, 100.0, 7999.0, 768001.0, 1e6, 1e7, 0.0, -48000.0, noNumber, infinite})
        for (const auto mode : modes) {
            INFO(rate << " Hz, " << name(mode));
            processor.parameters().mode() = static_cast<int>(mode);
            REQUIRE_NOTHROW(processor.prepareToPlay(rate, 512));
            CHECK(processor.getLatencySamples() == latency);
            CHECK(isLate(u, played<float>(processor, u, 0), latency));
            processor.reset();
            CHECK(isLate(u, played<double>(processor, u, 1), latency));
            processor.reset();
            CHECK(isLate(u, played<float>(processor, u, 1, true), latency));
        }
    Editor editor(processor);
    CHECK(editor.status().contains("sample rate"));
    processor.prepareToPlay(48000.0, 512);
    editor.update();
    CHECK_FALSE(editor.status().contains("sample rate"));
    processor.parameters().mode() = static_cast<int>(Mode::speaker);
    CHECK_FALSE(isLate(u, played<float>(processor, u, 0), latency));
}

TEST_CASE("At every rate at which the engine can run, and for blocks of any announced length, the same latency and "
          "finite samples",
          "[plugin]")
{
    const auto u = noise(3000);
    Processor processor;
    const int latency = processor.getLatencySamples();
    processor.parameters().mode() = static_cast<int>(Mode::audition);
    for (const double rate : {8000.0, 11025.0, 48000.5, 192000.0, 768000.0})
        for (const int block : {0, -1, 1, 1 << 30}) {
            INFO(rate << " Hz, blocks of " << block);
            REQUIRE_NOTHROW(processor.prepareToPlay(rate, block));
            CHECK(processor.getLatencySamples() == latency);
            bool finite = true;
            for (const float sample : played<float>(processor, u, 0))
                finite = finite && std::isfinite(sample);
            CHECK(finite);
        }
}

TEST_CASE("Models and states are taken at a rate at which the engine cannot run, and are played once it can",
          "[plugin]")
{
    const auto& drivers = plugin::factoryDrivers();
    const auto other = plugin::modelFromText(drivers.back().text, "a driver");
    Processor from;
    from.setModel(other);
    from.parameters().mode() = static_cast<int>(Mode::speaker);
    const auto state = stateOf(from);
    for (const double rate : {100.0, 1e6, noNumber}) {
        INFO(rate << " Hz");
        Processor processor;
        processor.prepareToPlay(rate, 256);
        REQUIRE_NOTHROW(processor.setModel(other));
        CHECK(processor.model().name == other.name);
        processor.setStateInformation(state.getData(), static_cast<int>(state.getSize()));
        CHECK(stateOf(processor) == state);
        processor.prepareToPlay(48000.0, 256);
        from.prepareToPlay(48000.0, 256);
        const auto u = noise(3000);
        CHECK(played<float>(processor, u, 0) == played<float>(from, u, 0));
        auto broken = other;
        broken.baseParameter("Bl").value = 0.0;
        processor.prepareToPlay(rate, 256);
        CHECK_THROWS_AS(processor.setModel(broken), Error);
        CHECK(processor.model().baseParameter("Bl").value > 0.0);
    }
}

TEST_CASE("Samples that come after the resources were released, or before any were taken, crash nothing", "[plugin]")
{
    const auto u = noise(2000);
    Processor processor;
    CHECK(played<float>(processor, u, 0).size() == u.size());
    for (const double rate : {48000.0, 1e6}) {
        processor.prepareToPlay(rate, 64);
        processor.releaseResources();
        bool finite = true;
        for (const float sample : played<float>(processor, u, 0))
            finite = finite && std::isfinite(sample);
        CHECK(finite);
    }
}
