// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linearization/Recipe.h"

#include "Engine/Driver/Catalogue.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

constexpr auto formatName = "excursion-recipe";
constexpr int formatVersion = 1;

struct Names {
    std::string_view name, title;
};
constexpr std::array<Names, modes.size()> names {{{"bypass", "Bypass"},
                                                  {"speaker", "Speaker"},
                                                  {"distortion", "Distortion alone"},
                                                  {"linearize", "Linearize"},
                                                  {"audition", "Audition"}}};

struct Range {
    double least, most;
    bool holds(double value) const { return value >= least && value <= most; }
};
constexpr Range fullScales {0.01, 1000.0}, amounts {0.0, 1.0}, displacements {0.05, 4.0}, voltages {0.01, 1000.0}, trims {-60.0, 24.0};

} // namespace

std::string_view name(Mode mode) { return names[static_cast<std::size_t>(mode)].name; }
std::string_view title(Mode mode) { return names[static_cast<std::size_t>(mode)].title; }

bool Recipe::isValid(std::string* reason) const
{
    const auto check = [reason](bool holds, const char* sentence) { return holds || refuse(reason, sentence); };
    return check(fullScales.holds(fullScale), "the voltage of full scale must lie between 0.01 and 1000 V")
        && check(amounts.holds(amount), "the amount must lie between 0 and 1")
        && check(displacements.holds(displacementLimit), "the limit of the excursion must lie between 0.05 and 4 times what was measured")
        && check(voltages.holds(voltageLimit), "the limit of the voltage must lie between 0.01 and 1000 V")
        && check(trims.holds(trimDb), "the trim must lie between -60 and 24 dB");
}

Model withoutOff(const Model& model, const Recipe& recipe)
{
    auto result = model;
    for (const auto& id : recipe.off)
        if (result.has(id))
            result = withoutEffect(result, id);
    return result;
}

LinearizationControls controlsOf(const Recipe& recipe, const Model& model)
{
    return {recipe.amount, recipe.displacementLimit * measuredDisplacement(model), recipe.voltageLimit};
}

nlohmann::ordered_json toJson(const Recipe& recipe)
{
    return {{"format", formatName}, {"version", formatVersion}, {"title", recipe.title}, {"words", recipe.words},
            {"mode", name(recipe.mode)}, {"fullScale", recipe.fullScale}, {"amount", recipe.amount},
            {"displacementLimit", recipe.displacementLimit}, {"voltageLimit", recipe.voltageLimit}, {"trimDb", recipe.trimDb},
            {"off", recipe.off}};
}

Recipe recipeFromJson(const JsonField& field)
{
    field.requireFormat(formatName, formatVersion);
    const auto within = [&field](const char* key, const Range& range) { return field.at(key).numberWithin(range.least, range.most); };
    Recipe recipe;
    recipe.title = field.at("title").text();
    recipe.words = field.at("words").text();
    std::vector<std::string> known;
    for (const auto mode : modes)
        known.emplace_back(name(mode));
    const auto mode = field.at("mode").oneOf(known);
    recipe.mode = modes[static_cast<std::size_t>(std::find(known.begin(), known.end(), mode) - known.begin())];
    recipe.fullScale = within("fullScale", fullScales);
    recipe.amount = within("amount", amounts);
    recipe.displacementLimit = within("displacementLimit", displacements);
    recipe.voltageLimit = within("voltageLimit", voltages);
    recipe.trimDb = within("trimDb", trims);
    known.clear();
    for (const auto* effect : catalogue())
        known.push_back(effect->id());
    for (const auto& item : field.at("off").items())
        recipe.off.push_back(item.oneOf(known));
    return recipe;
}

Recipe readRecipe(const std::filesystem::path& path)
{
    const auto document = readJson(path);
    return recipeFromJson(JsonField(document, "", path.string()));
}

} // namespace excursion
