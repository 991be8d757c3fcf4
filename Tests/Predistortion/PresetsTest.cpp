// SPDX-License-Identifier: GPL-3.0-or-later
// The factory's drivers and recipes, read from the source folder.
#include "Predistortion/Drivers.h"

#include "Engine/Loudspeaker/Laws.h"
#include "Engine/Loudspeaker/ModelFile.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Predistortion/Chain.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <set>

using namespace excursion;

namespace {

std::vector<std::filesystem::path> files(const std::string& folder)
{
    std::vector<std::filesystem::path> result;
    for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path("Presets") / folder))
        result.push_back(entry.path());
    std::sort(result.begin(), result.end());
    return result;
}

}  // namespace

TEST_CASE("Every factory driver loads, is stable, has laws that make sense and a level that does", "[presets][slow]")
{
    const auto drivers = files("drivers");
    CHECK(drivers.size() >= 6);
    std::set<std::string> titles;
    bool seed = false;
    for (const auto& file : drivers) {
        INFO(file.string());
        const auto model = readModel(file);
        titles.insert(model.name);
        CHECK_NOTHROW(requireRunnable(model, {}));
        CHECK(model.effectIds().size() >= 6);
        for (const auto& law : laws(model))
            for (const double value : law.value) {
                INFO(law.info.name);
                const double rest = law.value[law.value.size() / 2];
                CHECK(value > (law.info.argument == "v" ? 0.99 : 0.3) * rest);  // air resists more as it is faster
                CHECK(value < 3.0 * rest);
            }
        seed = seed
               || (model.baseParameter("m").value == 14.35e-3 && model.baseParameter("Rms").value == 0.786
                   && model.baseParameter("K").value == 1852.0 && model.baseParameter("Bl").value == 4.95
                   && model.baseParameter("Le").value == 266e-6 && model.baseParameter("Re").value == 3.3);

        // 2.83 V at 1 m, four times the resonance: what such drivers do is between 65 and 100 dB.
        const double f0 = std::sqrt(model.baseParameter("K").value / model.baseParameter("m").value)
                          / (2.0 * std::numbers::pi);
        CHECK(f0 > 20.0);
        CHECK(f0 < 600.0);
        const double pascal = 2.83 * std::abs(respond(model, {Quantity::pressure}, {4.0 * f0}).front().value.front());
        const double level = 20.0 * std::log10(pascal / 2e-5);
        INFO(level << " dB");
        CHECK(level > 65.0);
        CHECK(level < 100.0);

        // It plays, and is linearized, as loudly as it was measured; an output as loud as the input, more or less.
        const double atRest = std::abs(respond(model, {Quantity::displacement}, {0.5 * f0}).front().value.front());
        const double volts = 0.6 * measuredDisplacement(model) / atRest;
        for (const auto mode : modes) {
            INFO(name(mode));
            ChainControls controls {mode, volts, 1.0, controlsOf({}, model)};
            Chain chain(model, {48000.0, 2}, controls);
            std::vector<double> u(48000);
            for (std::size_t n = 0; n < u.size(); ++n) {
                const double t = static_cast<double>(n) / 48000.0;
                u[n] = 0.8 * std::sin(std::numbers::pi * f0 * t)
                       + 0.2 * std::sin(2.0 * std::numbers::pi * 6.3 * f0 * t);
            }
            const double before = rms(u), after = rms(through(chain, u));
            CHECK(after < 4.0 * before);
            CHECK(after > (mode == Mode::distortion ? 0.0005 : 0.03) * before);
            const auto meters = chain.collectMeters();
            CHECK(meters.predistorter.faults + meters.speaker.faults == 0);
            if (mode == Mode::audition)
                CHECK(meters.speaker.displacement < 1.05 * measuredDisplacement(model));
        }
    }
    CHECK(titles.size() == drivers.size());
    CHECK(seed);
}

TEST_CASE("Every recipe loads, and is one that can be kept", "[presets]")
{
    const auto recipes = files("recipes");
    CHECK(recipes.size() >= 3);
    for (const auto& file : recipes) {
        INFO(file.string());
        const auto recipe = readDocument(file, recipeFromJson);
        std::string reason;
        CHECK(recipe.isValid(&reason));
        CHECK(reason.empty());
        CHECK_FALSE(recipe.words.empty());
        const nlohmann::json again = nlohmann::json::parse(toJson(recipe).dump());
        CHECK(again == readJson(file));
    }
}
