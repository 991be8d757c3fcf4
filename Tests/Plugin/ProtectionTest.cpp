// SPDX-License-Identifier: GPL-3.0-or-later
// What leaves the plugin, given to the plugin's own drivers as a simulation moves them; nothing is asked of the meters.
#include "Plugin/Processor.h"
#include "Predistortion/Programme.h"

#include "Engine/Loudspeaker/Simulate.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace excursion;
using plugin::Processor;

namespace {

constexpr double rate = 48000.0;

/// Plays in mono blocks of 256; before each block `change` may set things.
template <class Change>
std::vector<double> played(Processor& processor, const std::vector<double>& u, const Change& change)
{
    std::vector<double> out;
    juce::MidiBuffer midi;
    for (std::size_t n = 0; n + 256 <= u.size(); n += 256) {
        change(n);
        juce::AudioBuffer<double> buffer(2, 256);
        for (int c = 0; c < 2; ++c)
            std::copy(u.begin() + static_cast<std::ptrdiff_t>(n), u.begin() + static_cast<std::ptrdiff_t>(n + 256),
                      buffer.getWritePointer(c));
        processor.processBlock(buffer, midi);
        out.insert(out.end(), buffer.getReadPointer(1), buffer.getReadPointer(1) + 256);
    }
    return out;
}

double peakOf(const std::vector<double>& values, std::size_t from = 0)
{
    double result = 0.0;
    for (std::size_t n = from; n < values.size(); ++n)
        result = std::max(result, std::abs(values[n]));
    return result;
}

double farthest(const Model& model, std::vector<double> output, double fullScale)
{
    for (auto& sample : output)
        sample *= fullScale;
    return peakOf(simulate(model, output, rate, {}).find(Quantity::displacement)->samples);
}

Recipe linearizing(double fullScale, double voltageLimit)
{
    Recipe recipe;
    recipe.mode = Mode::linearize;
    recipe.fullScale = fullScale;
    recipe.voltageLimit = voltageLimit;
    return recipe;
}

std::vector<double> tone(double frequency, double amplitude, double seconds)
{
    std::vector<double> u(static_cast<std::size_t>(seconds * rate));
    for (std::size_t n = 0; n < u.size(); ++n)
        u[n] = amplitude * std::sin(2.0 * std::numbers::pi * frequency * static_cast<double>(n) / rate)
               * std::min(1.0, static_cast<double>(n) / 2400.0);
    return u;
}

double largestBend(const std::vector<double>& u, std::size_t from, std::size_t to)
{
    double result = 0.0;
    for (std::size_t n = from + 1; n + 1 < to; ++n)
        result = std::max(result, std::abs(u[n + 1] - 2.0 * u[n] + u[n - 1]));
    return result;
}

}  // namespace

TEST_CASE("Every factory driver stays within its excursion and the voltage within its limit and the converter's, with "
          "loud pink noise",
          "[plugin][protection]")
{
    for (const auto& factory : plugin::factoryDrivers())
        for (const auto& [fullScale, voltageLimit] :
             {std::pair {10.0, 25.0}, {40.0, 25.0}, {10.0, 10.0}, {40.0, 1000.0}}) {
            INFO(factory.title << ", " << fullScale << " V at 0 dBFS, limit " << voltageLimit << " V");
            Processor processor;
            const auto model = plugin::modelFromText(factory.text, factory.title);
            processor.setModel(model);
            processor.parameters().set(linearizing(fullScale, voltageLimit));
            processor.prepareToPlay(rate, 256);
            Draw draw(11);
            auto u = pinkNoise(draw, static_cast<std::size_t>(1.5 * rate));
            for (auto& sample : u)
                sample *= std::pow(10.0, -2.9 / 20.0);
            const auto out = played(processor, u, [](std::size_t) {});
            CHECK(fullScale * peakOf(out) < 1.01 * voltageLimit);
            CHECK(peakOf(out) <= 1.0);
            CHECK(farthest(model, out, fullScale) < 1.01 * measuredDisplacement(model));
            // it plays, all the same
            CHECK(peakOf(out) > 0.05 * peakOf(u) * std::min(1.0, voltageLimit / fullScale));
        }
}

TEST_CASE("A person who just turns it on gets no more than the converter can give", "[plugin][protection]")
{
    Processor processor;
    processor.parameters().mode() = static_cast<int>(Mode::linearize);
    processor.prepareToPlay(rate, 256);
    const auto out = played(processor, tone(50.0, 1.0, 2.0), [](std::size_t) {});
    CHECK(peakOf(out) <= 1.0);
    CHECK(farthest(processor.model(), out, processor.parameters().recipe().fullScale)
          < 1.01 * measuredDisplacement(processor.model()));
}

TEST_CASE("Switching effects off leaves the limit of the excursion where the model as it was loaded has it",
          "[plugin][protection]")
{
    Processor processor;
    const auto model = processor.model();
    auto recipe = linearizing(40.0, 1000.0);
    recipe.off = model.effectIds();
    processor.parameters().set(recipe);
    processor.prepareToPlay(rate, 256);
    const auto u = tone(40.0, 1.0, 1.5);
    const auto out = played(processor, u, [](std::size_t) {});
    const auto running = withoutOff(model, recipe);
    CHECK(farthest(running, u, recipe.fullScale) > 1.2 * measuredDisplacement(model));
    CHECK(farthest(running, out, recipe.fullScale) < 1.01 * measuredDisplacement(model));
}

TEST_CASE("Turning the excursion down brakes nothing: no voltage above 5 kHz", "[plugin][protection]")
{
    Processor processor;
    processor.parameters().set(linearizing(20.0, 1000.0));
    processor.prepareToPlay(rate, 256);
    auto recipe = processor.parameters().recipe();
    const auto out = played(processor, tone(40.0, 1.0, 3.0), [&](std::size_t n) {
        recipe.displacementLimit = n < 48000 ? 1.0 : 0.1;
        processor.parameters().set(recipe);
    });
    CHECK(peakOf(out) <= 1.0);
    const double treble = 10.0 * std::log10(powerAbove(5000.0, out, rate));
    INFO(treble << " dBFS above 5 kHz");
    CHECK(treble < -90.0);
}

TEST_CASE("Swapping models and switching effects is not heard as a click", "[plugin][protection]")
{
    for (const auto mode : modes)
        for (const bool switches : {false, true}) {
            INFO(name(mode) << (switches ? ", effects" : ", models"));
            Processor processor;
            auto recipe = linearizing(5.0, 1000.0);
            recipe.mode = mode;
            processor.parameters().set(recipe);
            processor.prepareToPlay(rate, 256);
            const auto& drivers = plugin::factoryDrivers();
            const std::size_t change = 188 * 256;
            const auto out = played(processor, tone(150.0, 0.2, 2.5), [&](std::size_t n) {
                if (n != change)
                    return;
                if (switches)
                    processor.parameters().effects().front()->setValueNotifyingHost(0.0f);
                else
                    processor.setModel(plugin::modelFromText(drivers[1].text, drivers[1].title));
                juce::Thread::sleep(100);  // the worker builds
            });
            const double steady = std::max(largestBend(out, change / 2, change),
                                           largestBend(out, out.size() - change / 2, out.size()));
            CHECK(largestBend(out, change, out.size()) < 3.0 * steady);
            if (mode == Mode::bypass)
                CHECK(largestBend(out, change, out.size()) < 1.001 * steady);
        }
}
