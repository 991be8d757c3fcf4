// SPDX-License-Identifier: GPL-3.0-or-later
// What is saved comes back exactly, or is refused.
#include "Plugin/Played.h"
#include "Plugin/Processor.h"

#include <catch2/catch.hpp>

#include <limits>
#include <random>
#include <vector>

using namespace excursion;
using namespace excursion::test;
using plugin::Processor;

namespace {

void restore(Processor& processor, const juce::MemoryBlock& state)
{
    processor.setStateInformation(state.getData(), static_cast<int>(state.getSize()));
}

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

}  // namespace

TEST_CASE("A number between two steps stands for the one next to it, and stays what a host has sent", "[plugin]")
{
    Processor processor;
    for (auto* on : processor.parameters().effects()) {
        on->setValue(0.84f);
        CHECK(on->get());
        CHECK(on->getValue() == 0.84f);
        on->setValue(0.49f);
        CHECK_FALSE(on->get());
        CHECK(on->getText(on->getValue(), 0) == "Off");
    }
    auto& mode = processor.parameters().mode();
    mode.setValue(0.84f);
    CHECK(mode.getIndex() == 3);
    mode = 2;
    CHECK(mode.getValue() == 0.5f);
    std::mt19937 random(9);
    for (auto* parameter : processor.getParameters()) {
        INFO(parameter->getName(40));
        for (int k = 0; k < 2000; ++k) {
            const float sent = static_cast<float>(random()) / 4294967296.0f;
            parameter->setValue(sent);
            // at the lower end of a long scale the numbers are closer than values can be
            CHECK(parameter->getValue() == Approx(sent).margin(3e-3));
            if (k % 100 != 0)
                continue;
            const auto state = stateOf(processor);
            parameter->setValue(parameter->getValue());
            CHECK(stateOf(processor) == state);
        }
        parameter->setValue(std::numeric_limits<float>::quiet_NaN());
        CHECK(parameter->getValue() == 0.0f);
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

TEST_CASE(
    "What a host shows when a state is saved is what it shows when it has been restored, whatever numbers it had sent",
    "[plugin]")
{
    // As a host: it shows what it has sent until it is told something else, and reads all anew when it has restored a
    // state.
    struct Host : juce::AudioProcessorListener {
        explicit Host(Processor& of) : processor(of) { processor.addListener(this); }
        ~Host() override { processor.removeListener(this); }
        void audioProcessorParameterChanged(juce::AudioProcessor*, int index, float value) override
        {
            shown[static_cast<std::size_t>(index)] = value;
        }
        void audioProcessorChanged(juce::AudioProcessor*, const ChangeDetails&) override {}
        void send(std::size_t index, float value)
        {
            shown[index] = value;
            processor.getParameters()[static_cast<int>(index)]->setValue(value);
        }
        Processor& processor;
        std::vector<float> shown = std::vector<float>(static_cast<std::size_t>(processor.getParameters().size()));
    };
    std::mt19937 random(0x444);
    Processor processor;
    Host host(processor);
    const auto shake = [&] {
        for (std::size_t k = 0; k < host.shown.size(); ++k)
            host.send(k, static_cast<float>(random()) / 4294967296.0f);
    };
    for (int round = 0; round < 200; ++round) {
        shake();
        const auto state = stateOf(processor);
        const auto shown = host.shown;
        shake();
        restore(processor, state);
        for (std::size_t k = 0; k < shown.size(); ++k) {
            INFO(processor.getParameters()[static_cast<int>(k)]->getName(40));
            // At the low end of a skewed dial neighbouring numbers differ by less than the digits of a document.
            const double lowEnd = 3e-3;
            CHECK(processor.getParameters()[static_cast<int>(k)]->getValue()
                  == Approx(shown[k]).margin(shown[k] < lowEnd ? lowEnd : 1e-3));
        }
    }
}

TEST_CASE(
    "Everything that a recipe may hold is held as it is, between the steps of a dial too; what it may not is refused",
    "[plugin]")
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
        const auto before = toJson(processor.parameters().recipe()).dump();
        restore(processor, changed([&](auto& document) {
                    document["recipe"]["fullScale"] = volts;
                    document["recipe"]["trimDb"] = 3.0;
                }));
        CHECK(toJson(processor.parameters().recipe()).dump() == before);
        CHECK_FALSE(processor.refusal().empty());
    }
}

TEST_CASE("Numbers between steps that contradict the recipe are not taken, and a state with impossible ones is refused",
          "[plugin]")
{
    Processor processor;
    restore(processor, changed([](auto& document) {
                document["between"] = {{"mode", 0.84}, {"effect-creep", 0.84}, {"effect-of-a-later-version", 0.5}};
            }));
    CHECK(processor.parameters().mode().getValue() == 0.0f);
    CHECK(processor.parameters().effects()[4]->getValue() == 0.84f);
    const auto before = toJson(processor.parameters().recipe()).dump();
    for (const nlohmann::json& impossible :
         {nlohmann::json({{"mode", 1.5}}), nlohmann::json({{"mode", "loud"}}), nlohmann::json(3)}) {
        restore(processor, changed([&](auto& document) {
                    document["between"] = impossible;
                    document["recipe"]["mode"] = "speaker";
                }));
        CHECK(toJson(processor.parameters().recipe()).dump() == before);
        CHECK_FALSE(processor.refusal().empty());
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
