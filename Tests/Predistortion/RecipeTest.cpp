// SPDX-License-Identifier: GPL-3.0-or-later
#include "Predistortion/Drivers.h"

#include "Engine/Error.h"
#include "Engine/Predistortion/Recipe.h"

#include <catch2/catch.hpp>

#include <string>

using namespace excursion;

TEST_CASE("A recipe is refused by field when it makes no sense", "[chain]")
{
    auto document = nlohmann::json::parse(toJson(Recipe {}).dump());
    const auto refused = [&](const char* key, const nlohmann::json& value) {
        auto broken = document;
        broken[key] = value;
        try {
            recipeFromJson(JsonField(broken, "", "r.json"));
            FAIL("not refused: " << key);
        } catch (const Error& error) {
            CHECK(std::string(error.what()).find(key) != std::string::npos);
        }
    };
    CHECK_NOTHROW(recipeFromJson(JsonField(document, "", "r.json")));
    refused("mode", "loud");
    refused("amount", 2);
    refused("fullScale", 0);
    refused("displacementLimit", "far");
    refused("voltageLimit", -1);
    refused("trimDb", 100);
    refused("off", nlohmann::json::array({"warp-drive"}));
    refused("version", 6);
    refused("coupling", 25);
    refused("couplingOrder", 3);
    refused("target", "low");
}

TEST_CASE("Effects that a recipe switches off are not in the model that is run", "[chain]")
{
    Recipe recipe;
    recipe.off = {"creep", "stiffness"};
    const auto model = withoutOff(withoutEffect(everything(), "creep"), recipe);
    CHECK(model.effectIds().size() == everything().effectIds().size() - 2);
    CHECK_FALSE(model.has("stiffness"));
}
