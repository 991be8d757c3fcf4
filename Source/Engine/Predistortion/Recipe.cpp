// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/Recipe.h"

#include "Engine/Document/DocumentFormat.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

constexpr DocumentFormat recipeFormat {"excursion-recipe", 5};

struct Names {
    std::string_view name, title;
};
constexpr std::array<Names, modes.size()> names {{{"bypass", "Bypass"},
                                                  {"speaker", "Speaker"},
                                                  {"distortion", "Distortion alone"},
                                                  {"linearize", "Linearize"},
                                                  {"audition", "Audition"}}};

constexpr std::array<std::string_view, 6> targetKinds {"own", "resonance", "closed-box", "flat", "bands", "response"};

/// Version 1 knew neither a limit of the power nor a margin, version 2 no target, version 3 no resistance and
/// no target that equalizes, version 4 no amplifier.
int versionOf(const JsonField& field)
{
    const auto number = field.at("version");
    int version = recipeFormat.version;
    while (version > 1 && number.value() != version)
        --version;
    if (number.value() != version)
        number.refuse("1 to 5, the versions that this program reads");
    DocumentFormat {recipeFormat.name, version}.require(field);
    return version;
}

ThirdOctaves curveFrom(const JsonField& field)
{
    const auto items = field.items();
    ThirdOctaves curve {};
    if (items.size() != curve.size())
        field.refuse("a level for each third of an octave from 20 Hz to 20 kHz, " + std::to_string(curve.size())
                     + " of them, null where none is given");
    for (std::size_t k = 0; k < curve.size(); ++k)
        curve[k] = items[k].value().is_null()
                       ? Target::notGiven
                       : items[k].numberWithin(Settings::targetLevels.least, Settings::targetLevels.most);
    return curve;
}

Target targetFrom(const JsonField& field, int version)
{
    const std::vector<std::string> kinds(targetKinds.begin(),
                                         version > 3 ? targetKinds.end() : targetKinds.begin() + 3);
    const auto within = [&field](const char* key, const Settings::Range& range) {
        return field.at(key).numberWithin(range.least, range.most);
    };
    const auto kind = std::find(kinds.begin(), kinds.end(), field.at("kind").oneOf(kinds)) - kinds.begin();
    Target target {static_cast<Target::Kind>(kind), within("f0", Settings::targetFrequencies),
                   within("q", Settings::targetQualities), within("volume", Settings::targetVolumes)};
    if (version > 3) {
        target.low = within("low", Settings::targetEnds);
        target.high = within("high", Settings::targetEnds);
        target.curve = curveFrom(field.at("curve"));
    }
    return target;
}

nlohmann::ordered_json documentOf(const Target& target)
{
    auto curve = nlohmann::ordered_json::array();
    for (const double level : target.curve)
        curve.push_back(level == Target::notGiven ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(level));
    return {{"kind", targetKinds[static_cast<std::size_t>(target.kind)]},
            {"f0", target.frequency},
            {"q", target.quality},
            {"volume", target.volume},
            {"low", target.low},
            {"high", target.high},
            {"curve", curve}};
}

}  // namespace

std::string_view name(Mode mode) { return names[static_cast<std::size_t>(mode)].name; }
std::string_view title(Mode mode) { return names[static_cast<std::size_t>(mode)].title; }

bool Recipe::isValid(std::string* reason) const
{
    const auto check = [reason](bool holds, const char* sentence) { return holds || refuse(reason, sentence); };
    return check(fullScales.holds(fullScale), "the voltage of full scale must lie between 0.01 and 1000 V")
           && check(amounts.holds(amount), "the amount must lie between 0 and 1")
           && check(displacements.holds(displacementLimit),
                    "the limit of the excursion must lie between 0.05 and 4 times what was measured")
           && check(voltages.holds(voltageLimit), "the limit of the voltage must lie between 0.01 and 1000 V")
           && check(powers.holds(powerLimit), "the limit of the power must lie between 0.01 and 10000 W")
           && check(margins.holds(margin), "the margin must lie between 0 and 0.3")
           && check(resistances.holds(coilResistance), "the resistance of a coil must lie between 0 and 1000 ohm")
           && check(trims.holds(trimDb), "the trim must lie between -60 and 24 dB")
           && check(couplings.holds(coupling), "the corner of the amplifier must lie between 0 and 20 Hz")
           && check(couplingOrder == 1 || couplingOrder == 2, "the order of the amplifier's high-pass must be 1 or 2")
           && check(targetFrequencies.holds(target.frequency) && targetQualities.holds(target.quality)
                        && targetVolumes.holds(target.volume) && targetEnds.holds(target.low)
                        && targetEnds.holds(target.high) && target.areSound(),
                    "a target must lie between 5 and 5000 Hz, a Q of 0.2 and 3, 0.1 and 1000 l, in a band of 20 to "
                    "20000 Hz, with levels of -200 to 300 dB");
}

Model withoutOff(const Model& model, const Recipe& recipe)
{
    auto result = model;
    for (const auto& id : recipe.off)
        if (result.has(id))
            result = withoutEffect(result, id);
    return result;
}

PredistortionControls controlsOf(const Settings& settings, double measuredDisplacement)
{
    PredistortionControls controls;
    controls.amount = settings.amount;
    controls.displacementLimit = settings.displacementLimit * measuredDisplacement;
    controls.voltageLimit = std::min(settings.voltageLimit, settings.fullScale);
    if (settings.powerLimit < Settings::powers.most)
        controls.powerLimit = settings.powerLimit;
    controls.margin = settings.margin;
    controls.coilResistance = settings.coilResistance;
    controls.target = settings.target;
    return controls;
}

PredistortionControls controlsOf(const Recipe& recipe, const Model& model)
{
    return controlsOf(static_cast<const Settings&>(recipe), measuredDisplacement(model));
}

AmplifierCoupling couplingOf(const Settings& settings)
{
    if (settings.coupling < 0.5 * AmplifierCoupling::lowest)
        return {};
    return {std::max(settings.coupling, AmplifierCoupling::lowest), settings.couplingOrder};
}

nlohmann::ordered_json toJson(const Recipe& recipe)
{
    return recipeFormat.with({{"title", recipe.title},
                              {"words", recipe.words},
                              {"mode", name(recipe.mode)},
                              {"fullScale", recipe.fullScale},
                              {"amount", recipe.amount},
                              {"displacementLimit", recipe.displacementLimit},
                              {"voltageLimit", recipe.voltageLimit},
                              {"powerLimit", recipe.powerLimit},
                              {"margin", recipe.margin},
                              {"coilResistance", recipe.coilResistance},
                              {"trimDb", recipe.trimDb},
                              {"coupling", recipe.coupling},
                              {"couplingOrder", recipe.couplingOrder},
                              {"target", documentOf(recipe.target)},
                              {"off", recipe.off}});
}

Recipe recipeFromJson(const JsonField& field)
{
    const int version = versionOf(field);
    const auto within = [&field](const char* key, const Settings::Range& range) {
        return field.at(key).numberWithin(range.least, range.most);
    };
    Recipe recipe;
    recipe.title = field.at("title").text();
    recipe.words = field.at("words").text();
    std::vector<std::string> known;
    for (const auto mode : modes)
        known.emplace_back(name(mode));
    const auto mode = field.at("mode").oneOf(known);
    recipe.mode = modes[static_cast<std::size_t>(std::find(known.begin(), known.end(), mode) - known.begin())];
    recipe.fullScale = within("fullScale", Settings::fullScales);
    recipe.amount = within("amount", Settings::amounts);
    recipe.displacementLimit = within("displacementLimit", Settings::displacements);
    recipe.voltageLimit = within("voltageLimit", Settings::voltages);
    if (version > 1) {
        recipe.powerLimit = within("powerLimit", Settings::powers);
        recipe.margin = within("margin", Settings::margins);
    }
    if (version > 3)
        recipe.coilResistance = within("coilResistance", Settings::resistances);
    recipe.trimDb = within("trimDb", Settings::trims);
    if (version > 4) {
        recipe.coupling = within("coupling", Settings::couplings);
        recipe.couplingOrder = field.at("couplingOrder").count(1, 2);
    }
    if (version > 2)
        recipe.target = targetFrom(field.at("target"), version);
    known.clear();
    for (const auto* effect : catalogue())
        known.push_back(effect->id());
    for (const auto& item : field.at("off").items())
        recipe.off.push_back(item.oneOf(known));
    return recipe;
}

}  // namespace excursion
