// SPDX-License-Identifier: GPL-3.0-or-later
// What a recipe says is what is played.
#include "Engine/Error.h"
#include "Plugin/Processor.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <thread>
#include <vector>

using namespace excursion;
using plugin::Processor;

namespace {

nlohmann::json documentOf(const Recipe& recipe) { return nlohmann::json::parse(toJson(recipe).dump()); }

Recipe read(const nlohmann::json& document) { return recipeFromJson(JsonField(document, "", "r.json")); }

Recipe drawn(std::mt19937& random)
{
    const auto within = [&random](const Settings::Range& range) {
        return std::uniform_real_distribution<>(range.least, range.most)(random);
    };
    Recipe recipe;
    recipe.mode = modes[random() % modes.size()];
    recipe.fullScale = within(Settings::fullScales);
    recipe.amount = within(Settings::amounts);
    recipe.displacementLimit = within(Settings::displacements);
    recipe.voltageLimit = within(Settings::voltages);
    recipe.powerLimit = within(Settings::powers);
    recipe.margin = within(Settings::margins);
    recipe.coilResistance = within(Settings::resistances);
    recipe.trimDb = within(Settings::trims);
    recipe.coupling = within(Settings::couplings);
    recipe.couplingOrder = 1 + static_cast<int>(random() % 2);
    recipe.target = {static_cast<Target::Kind>(random() % 6), within(Settings::targetFrequencies),
                     within(Settings::targetQualities), within(Settings::targetVolumes)};
    recipe.target.low = within(Settings::targetEnds);
    recipe.target.high = within(Settings::targetEnds);
    for (auto& level : recipe.target.curve)
        level = random() % 4 == 0 ? Target::notGiven : within(Settings::targetLevels);
    recipe.title = "of chance";
    return recipe;
}

}  // namespace

TEST_CASE(
    "A recipe of version 1 is read with no limit of the power and no margin, one of version 2 with no target, one of "
    "version 4 with no amplifier; a later version than ours is refused",
    "[plugin]")
{
    std::mt19937 random(2);
    const auto recipe = drawn(random);
    auto document = documentOf(recipe);
    CHECK(document["version"] == 5);
    CHECK(toJson(read(document)) == toJson(recipe));
    auto expected = recipe;
    document["version"] = 4;
    document.erase("coupling");
    document.erase("couplingOrder");
    expected.coupling = 0.0;
    expected.couplingOrder = 1;
    CHECK(toJson(read(document)) == toJson(expected));
    document["version"] = 5;
    CHECK_THROWS_WITH(read(document), Catch::Contains("coupling"));
    document["version"] = 3;
    document.erase("coilResistance");
    expected.coilResistance = 0.0;
    for (const auto* later : {"low", "high", "curve"})
        document["target"].erase(later);
    document["target"]["kind"] = "closed-box";
    expected.target = {Target::Kind::closedBox, recipe.target.frequency, recipe.target.quality, recipe.target.volume};
    CHECK(toJson(read(document)) == toJson(expected));
    document["version"] = 4;
    CHECK_THROWS_WITH(read(document), Catch::Contains("coilResistance"));
    document["version"] = 2;
    document.erase("target");
    expected.target = {};
    CHECK(toJson(read(document)) == toJson(expected));
    document["version"] = 3;
    CHECK_THROWS_WITH(read(document), Catch::Contains("target"));
    document["version"] = 1;
    document.erase("powerLimit");
    document.erase("margin");
    expected.powerLimit = 10000.0;
    expected.margin = 0.0;
    CHECK(toJson(read(document)) == toJson(expected));
    document["version"] = 2;
    CHECK_THROWS_WITH(read(document), Catch::Contains("powerLimit"));
    for (const nlohmann::json& version : {nlohmann::json(6), nlohmann::json("2"), nlohmann::json(0)}) {
        document["version"] = version;
        CHECK_THROWS_WITH(read(document), Catch::Contains("1 to 5"));
    }
    for (const auto& [key, value] :
         {std::pair {"powerLimit", 0.0}, {"powerLimit", 10001.0}, {"margin", -0.1}, {"margin", 0.31}}) {
        auto broken = documentOf(recipe);
        broken[key] = value;
        CHECK_THROWS_WITH(read(broken), Catch::Contains(key));
        auto invalid = recipe;
        (std::string(key) == "margin" ? invalid.margin : invalid.powerLimit) = value;
        std::string reason;
        CHECK_FALSE(invalid.isValid(&reason));
    }
    for (const auto& [key, value] : {std::pair<const char*, nlohmann::json> {"kind", "vented"},
                                     {"f0", 4.0},
                                     {"f0", nullptr},
                                     {"q", 0.0},
                                     {"volume", 2.0}}) {
        auto broken = documentOf(recipe);
        broken["target"][key] = value;
        CHECK_THROWS_WITH(read(broken), Catch::Contains(std::string("target.") + key));
    }
    auto invalid = recipe;
    invalid.target.quality = 10.0;
    CHECK_FALSE(invalid.isValid(nullptr));
}

TEST_CASE("The plugin's controls are those of its recipe, and no limit of the voltage is above full scale", "[plugin]")
{
    std::mt19937 random(3);
    Processor processor;
    const auto model = processor.model();
    for (int k = 0; k < 200; ++k) {
        const auto recipe = drawn(random);
        processor.parameters().set(recipe);
        const auto controls = processor.parameters().controls(measuredDisplacement(model));
        const auto expected = controlsOf(recipe, model);
        CHECK(controls.mode == recipe.mode);
        CHECK(controls.fullScale == recipe.fullScale);
        CHECK(controls.trim == Approx(std::pow(10.0, recipe.trimDb / 20.0)).epsilon(1e-14));
        CHECK(controls.predistortion.amount == expected.amount);
        CHECK(controls.predistortion.displacementLimit == expected.displacementLimit);
        CHECK(controls.predistortion.voltageLimit == expected.voltageLimit);
        CHECK(controls.predistortion.powerLimit == expected.powerLimit);
        CHECK(controls.predistortion.margin == expected.margin);
        CHECK(expected.voltageLimit == std::min(recipe.voltageLimit, recipe.fullScale));
        CHECK(expected.powerLimit == recipe.powerLimit);
        CHECK(expected.margin == recipe.margin);
        CHECK(controls.predistortion.target == recipe.target);
        CHECK(expected.target == recipe.target);
        CHECK(controls.predistortion.isValid(nullptr));
    }
    CHECK(controlsOf(Recipe {}, model).powerLimit == std::numeric_limits<double>::infinity());
}

TEST_CASE("A recipe that is set while a host is told of another replaces it as a whole", "[plugin]")
{
    std::mt19937 random(4);
    auto first = drawn(random), second = drawn(random);
    first.title = "first";
    second.title = "second";
    first.off = {"creep"};
    second.off = {"stiffness", "friction"};
    Processor processor;
    struct Host : juce::AudioProcessorListener {
        void audioProcessorParameterChanged(juce::AudioProcessor*, int, float) override { told(); }
        void audioProcessorChanged(juce::AudioProcessor*, const ChangeDetails&) override {}
        std::function<void()> told;
    } host;
    std::vector<std::string> seen;
    int calls = 0;
    host.told = [&] {
        seen.push_back(toJson(processor.parameters().recipe()).dump());
        if (++calls == 5)
            processor.parameters().set(second);
    };
    processor.addListener(&host);
    processor.parameters().set(first);
    processor.removeListener(&host);
    const auto one = toJson(first).dump(), other = toJson(second).dump();
    CHECK(toJson(processor.parameters().recipe()).dump() == other);
    for (const auto& recipe : seen)
        CHECK((recipe == one || recipe == other));
}

TEST_CASE("Who asks for the recipe while another thread sets one gets a whole one", "[plugin]")
{
    std::mt19937 random(5);
    auto first = drawn(random), second = drawn(random);
    first.title = "first";
    second.title = "second";
    first.off = {"creep"};
    second.off = {"stiffness", "friction"};
    const auto one = toJson(first).dump(), other = toJson(second).dump();
    Processor processor;
    processor.parameters().set(first);
    std::jthread setting([&](const std::stop_token& stop) {
        for (int k = 0; !stop.stop_requested(); ++k)
            processor.parameters().set(k % 2 == 0 ? second : first);
    });
    int mixed = 0;
    for (int k = 0; k < 3000; ++k) {
        const auto seen = toJson(processor.parameters().recipe()).dump();
        mixed += seen == one || seen == other ? 0 : 1;
    }
    CHECK(mixed == 0);
}

TEST_CASE("As the plugin is when it is just turned on, no sample leaves it that a converter could not give", "[plugin]")
{
    Processor processor;
    processor.parameters().mode() = static_cast<int>(Mode::linearize);
    processor.prepareToPlay(48000.0, 480);
    juce::MidiBuffer midi;
    float largest = 0.0f;
    for (const double frequency : {20.0, 45.0, 90.0, 400.0})
        for (int block = 0; block < 60; ++block) {
            juce::AudioBuffer<float> buffer(2, 480);
            for (int n = 0; n < 480; ++n)
                buffer.setSample(
                    0, n,
                    static_cast<float>(std::sin(2.0 * std::numbers::pi * frequency * (480 * block + n) / 48000.0)));
            buffer.copyFrom(1, 0, buffer, 0, 0, 480);
            processor.processBlock(buffer, midi);
            largest = std::max(largest, buffer.getMagnitude(0, 480));
        }
    CHECK(largest <= 1.0f);
    CHECK(largest > 0.5f);
}

TEST_CASE("Parameters keep their places when later versions have more of them", "[plugin]")
{
    Processor processor;
    juce::StringArray ids;
    for (auto* parameter : processor.getParameters())
        ids.add(dynamic_cast<juce::AudioProcessorParameterWithID&>(*parameter).paramID);
    CHECK(ids.joinIntoString(" ")
          == "mode fullScale amount displacementLimit voltageLimit trim effect-force-factor effect-stiffness "
             "effect-inductance-position "
             "effect-eddy-currents effect-creep effect-damping-velocity powerLimit margin effect-inductance-current "
             "effect-friction "
             "effect-coil-heating effect-vented-box effect-doppler effect-cone-breakup effect-side-resonance target "
             "targetF0 "
             "targetQ targetVolume coilResistance targetLow targetHigh coupling couplingOrder effect-port-and-air");
}
