// SPDX-License-Identifier: GPL-3.0-or-later
// What is saved comes back exactly, or is refused.
#include "Plugin/Processor.h"

#include <catch2/catch.hpp>

#include <random>

using namespace excursion;
using plugin::Processor;

namespace {

juce::MemoryBlock stateOf(Processor& processor)
{
    juce::MemoryBlock block;
    processor.getStateInformation(block);
    return block;
}

void restore(Processor& processor, const juce::MemoryBlock& state) { processor.setStateInformation(state.getData(), static_cast<int>(state.getSize())); }

/// The state of a fresh plugin, changed.
template <class Change>
juce::MemoryBlock changed(const Change& change)
{
    Processor processor;
    auto document = nlohmann::ordered_json::parse(stateOf(processor).toString().toStdString());
    change(document);
    const auto text = document.dump();
    return {text.data(), text.size()};
}

} // namespace

TEST_CASE("A parameter reports the value that it has, whatever number a host sends", "[plugin]")
{
    Processor processor;
    for (auto* on : processor.parameters().effects()) {
        auto& parameter = static_cast<juce::AudioProcessorParameter&>(*on);
        parameter.setValue(0.84f);
        CHECK(parameter.getValue() == 1.0f);
        parameter.setValue(0.49f);
        CHECK(parameter.getValue() == 0.0f);
    }
    auto& mode = static_cast<juce::AudioProcessorParameter&>(processor.parameters().mode());
    mode.setValue(0.84f);
    CHECK(mode.getValue() == 0.75f);
    std::mt19937 random(9);
    for (auto* parameter : processor.getParameters())
        for (int k = 0; k < 2000; ++k) {
            parameter->setValue(static_cast<float>(random()) / 4294967296.0f);
            const float value = parameter->getValue();
            parameter->setValue(value);
            CHECK(parameter->getValue() == value);
        }
}

TEST_CASE("All parameters come back from a state bit for bit, whatever numbers a host had sent", "[plugin]")
{
    std::mt19937 random(0x444);
    const auto shake = [&random](Processor& processor) {
        for (auto* parameter : processor.getParameters())
            parameter->setValue(static_cast<float>(random()) / 4294967296.0f);
    };
    Processor processor, other;
    for (int round = 0; round < 200; ++round) {
        shake(processor);
        shake(other);
        const auto state = stateOf(processor);
        restore(other, state);
        for (int k = 0; k < processor.getParameters().size(); ++k) {
            INFO(processor.getParameters()[k]->getName(40));
            CHECK(other.getParameters()[k]->getValue() == processor.getParameters()[k]->getValue());
        }
        CHECK(stateOf(other) == state);
    }
}

TEST_CASE("Everything that a recipe may hold is held as it is, between the steps of a dial too; what it may not is refused", "[plugin]")
{
    for (const double volts : {0.01, 2.8284271247461903, 200.01, 500.0, 1000.0}) {
        INFO(volts << " V");
        Processor processor;
        const auto state = changed([&](auto& document) {
            document["recipe"]["fullScale"] = volts;
            document["recipe"]["voltageLimit"] = volts;
            document["recipe"]["amount"] = 1.0 / 3.0;
            document["recipe"]["displacementLimit"] = 0.123456789;
            document["recipe"]["trimDb"] = -0.987654321;
        });
        restore(processor, state);
        const auto recipe = processor.parameters().recipe();
        CHECK(recipe.fullScale == volts);
        CHECK(recipe.voltageLimit == volts);
        CHECK(recipe.amount == 1.0 / 3.0);
        CHECK(recipe.displacementLimit == 0.123456789);
        CHECK(recipe.trimDb == -0.987654321);
        CHECK(processor.parameters().controls(1.0).fullScale == volts);
        const auto once = stateOf(processor);
        // A host that writes back what it reads moves nothing.
        for (auto* parameter : processor.getParameters())
            parameter->setValue(parameter->getValue());
        CHECK(stateOf(processor) == once);
    }
    for (const double volts : {0.0, 0.009, 1000.1, -10.0}) {
        INFO(volts << " V");
        Processor processor;
        const auto before = stateOf(processor);
        restore(processor, changed([&](auto& document) {
            document["recipe"]["fullScale"] = volts;
            document["recipe"]["trimDb"] = 3.0;
        }));
        CHECK(stateOf(processor) == before);
    }
}

TEST_CASE("Title and words of a recipe are kept, also when a person then moves something", "[plugin]")
{
    Processor processor;
    const auto recipe = plugin::recipeFromText(plugin::factoryRecipes().front().text, "a recipe");
    REQUIRE_FALSE(recipe.title.empty());
    REQUIRE_FALSE(recipe.words.empty());
    processor.parameters().set(recipe);
    processor.getParameters()[2]->setValueNotifyingHost(0.25f);
    const auto state = stateOf(processor);
    CHECK(stateOf(processor) == state);
    Processor other;
    restore(other, state);
    CHECK(other.parameters().recipe().title == recipe.title);
    CHECK(other.parameters().recipe().words == recipe.words);
    CHECK(stateOf(other) == state);
}
