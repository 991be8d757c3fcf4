// SPDX-License-Identifier: GPL-3.0-or-later
// What a host and a person may do to the processor, in any order.
#include "BlackBox/EveryClass.h"
#include "Plugin/Played.h"
#include "Plugin/Processor.h"

#include "Engine/BlackBox/PlayedBox.h"
#include "Engine/Error.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

using namespace excursion;
using namespace excursion::test;
using plugin::Processor;

namespace {

juce::AudioBuffer<float> noise(std::mt19937& random, int channels, int length)
{
    juce::AudioBuffer<float> buffer(channels, length);
    for (int c = 0; c < channels; ++c)
        for (int n = 0; n < length; ++n)
            buffer.setSample(c, n, static_cast<float>(random() % 2001) / 1000.0f - 1.0f);
    return buffer;
}

/// Whatever was before: half a second after linearizing was chosen the limits of voltage and excursion are kept.
void checkLimits(Processor& processor, std::mt19937& random, double rate, int channels)
{
    const auto box = processor.box();
    if (!processor.standstill().empty() || (box && !box->played.rehearsal))
        return;  // the signal goes through as it is
    processor.parameters().mode() = static_cast<int>(Mode::linearize);
    juce::MidiBuffer midi;
    double loudest = 0.0;
    const auto play = [&](double seconds) {
        loudest = 0.0;
        for (double left = seconds * rate; left > 0.0; left -= 512.0) {
            auto buffer = noise(random, channels, 512);
            processor.processBlock(buffer, midi);
            for (int c = 0; c < channels; ++c)
                loudest = std::max(loudest, static_cast<double>(buffer.getMagnitude(c, 0, 512)));
        }
    };
    play(0.5);
    processor.collectMeters();
    play(0.1);
    const double range = box ? measuredDisplacement(box->played) : measuredDisplacement(processor.model());
    const auto controls = processor.parameters().controls(range);
    CHECK(loudest * controls.fullScale <= controls.predistortion.voltageLimit * (1.0 + 1e-6));
    CHECK(processor.collectMeters().displacement <= 1.01 * controls.predistortion.displacementLimit);
}

/// Whatever a host and a person do, one after the other.
void operateAtRandom(unsigned seed, int operations)
{
    std::mt19937 random(seed);
    Processor processor;
    double rate = 48000.0;
    int channels = 2;
    processor.prepareToPlay(rate, 256);
    juce::MidiBuffer midi;
    auto kept = stateOf(processor);
    bool finite = true;
    std::vector<plugin::LoadedBoxPointer> boxes;
    for (const auto& box : everyClass())
        boxes.push_back(plugin::loadedBox(box, "a test"));
    for (int operation = 0; operation < operations; ++operation) {
        INFO("seed " << seed << ", operation " << operation);
        switch (random() % 13) {
        case 0:
            rate = std::array {44100.0, 48000.0, 96000.0, 100.0, 1e6}[random() % 5];  // where no engine runs, too
            processor.prepareToPlay(rate, std::array {1, 64, 256, 4096}[random() % 4]);
            break;
        case 1: kept = stateOf(processor); break;
        case 2: processor.setStateInformation(kept.getData(), static_cast<int>(kept.getSize())); break;
        case 3: {
            const auto& drivers = plugin::factoryDrivers();
            try {
                if (random() % 2 == 0)
                    processor.setModel(boxes[random() % boxes.size()]);
                else
                    processor.setModel(plugin::modelFromText(drivers[random() % drivers.size()].text, "a driver"));
            } catch (const Error&) {
                // A model that cannot be run at the rate, or with the switches as they are: the one before stays.
            }
            break;
        }
        case 4:
        case 5: {
            auto& all = processor.getParameters();
            all[static_cast<int>(random() % static_cast<unsigned>(all.size()))]->setValueNotifyingHost(
                static_cast<float>(random() % 1001) / 1000.0f);
            break;
        }
        case 6:
            if (random() % 2 == 0) {  // what no parameter is
                auto recipe = processor.parameters().recipe();
                for (auto& level : recipe.target.curve)
                    level = random() % 3 == 0 ? Target::notGiven : static_cast<double>(random() % 60) - 30.0;
                processor.parameters().set(recipe);
            } else {
                processor.reset();
            }
            break;
        case 7:
            if (random() % 8 == 0)
                checkLimits(processor, random, rate, channels);
            break;
        default: {
            auto buffer = noise(random, channels,
                                static_cast<int>(random() % 5 == 0 ? random() % 3000 : random() % 200));
            if (random() % 20 == 0 && buffer.getNumSamples() > 0)
                buffer.setSample(0, 0, std::numeric_limits<float>::quiet_NaN());
            random() % 10 == 0 ? processor.processBlockBypassed(buffer, midi) : processor.processBlock(buffer, midi);
            for (int c = 0; c < channels; ++c)
                for (int n = 0; n < buffer.getNumSamples(); ++n)
                    finite = finite && std::isfinite(buffer.getSample(c, n));
        }
        }
    }
    INFO("seed " << seed);
    CHECK(finite);
}

}  // namespace

TEST_CASE("2,000 random operations leave finite samples, and limits that are kept", "[plugin]")
{
    operateAtRandom(11, 2000);
}

TEST_CASE("10,000 random operations leave finite samples, and limits that are kept", "[.minutes]")
{
    operateAtRandom(12, 10000);
}
