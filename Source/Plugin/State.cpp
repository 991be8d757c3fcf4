// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/State.h"

#include "Engine/BlackBox/ModelDocument.h"
#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/ModelFile.h"

#include <FactoryDrivers.h>
#include <FactoryRecipes.h>

#include <algorithm>

namespace excursion::plugin {
namespace {

constexpr DocumentFormat stateFormat {"excursion-plugin-state"};

nlohmann::json parsed(std::string_view text, const std::string& where)
{
    requireShallow(text, where);
    auto document = nlohmann::json::parse(text, nullptr, false);
    if (!document.is_object())
        throw Error(Error::Kind::input, "'" + where + "' is no JSON document: give one that Excursion has written.");
    return document;
}

nlohmann::ordered_json toJson(const AnyModel& model)
{
    if (const auto* box = std::get_if<LoadedBoxPointer>(&model))
        return (*box)->document;
    return excursion::toJson(std::get<Model>(model));
}

/// @param bytes  the whole state: the document of a model without physics is kept as it was written
AnyModel anyModelFrom(const JsonField& field, std::string_view bytes, const LoadedBoxPointer& known)
{
    if (!isModelDocument(field))
        return modelFromJson(field);
    const auto document = nlohmann::ordered_json::parse(bytes).at("model");
    return known && known->document == document ? known : loadedBox(document, field.source());
}

double resonance(const Model& model) { return model.baseParameter("K").value / model.baseParameter("m").value; }

}  // namespace

std::string bytesOf(const State& state)
{
    nlohmann::ordered_json document = stateFormat.with(
        {{"recipe", excursion::toJson(state.recipe)}, {"model", toJson(state.model)}});
    if (!state.between.empty())
        document["between"] = state.between;
    return jsonText(document);
}

State stateFrom(std::string_view bytes, const LoadedBoxPointer& known)
{
    const std::string where = "the plugin's state";
    const auto document = parsed(bytes, where);
    const JsonField field(document, "", where);
    stateFormat.require(field);
    State state {recipeFromJson(field.at("recipe")), anyModelFrom(field.at("model"), bytes, known), {}};
    if (field.has("between")) {
        const auto between = field.at("between");
        for (const auto& id : between.keys())
            state.between[id] = between.at(id.c_str()).numberWithin(0.0, 1.0);
    }
    return state;
}

Model modelFromText(std::string_view text, const std::string& where)
{
    const auto document = parsed(text, where);
    return modelFromJson(document, where);
}

Recipe recipeFromText(std::string_view text, const std::string& where)
{
    const auto document = parsed(text, where);
    return recipeFromJson(JsonField(document, "", where));
}

const std::vector<Factory>& factoryDrivers()
{
    static const auto list = [] {
        std::vector<std::pair<double, Factory>> found;
        for (int k = 0; k < FactoryDrivers::namedResourceListSize; ++k) {
            int size = 0;
            const char* data = FactoryDrivers::getNamedResource(FactoryDrivers::namedResourceList[k], size);
            const std::string_view text(data, static_cast<std::size_t>(size));
            const auto model = modelFromText(text, FactoryDrivers::namedResourceList[k]);
            found.push_back({resonance(model), {model.name, text}});
        }
        std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
        std::vector<Factory> sorted;
        for (auto& [unused, factory] : found)
            sorted.push_back(std::move(factory));
        return sorted;
    }();
    return list;
}

const std::vector<Factory>& factoryRecipes()
{
    static const auto list = [] {
        std::vector<Factory> found;
        for (int k = 0; k < FactoryRecipes::namedResourceListSize; ++k) {
            int size = 0;
            const char* data = FactoryRecipes::getNamedResource(FactoryRecipes::namedResourceList[k], size);
            const std::string_view text(data, static_cast<std::size_t>(size));
            found.push_back({recipeFromText(text, FactoryRecipes::namedResourceList[k]).title, text});
        }
        return found;
    }();
    return list;
}

}  // namespace excursion::plugin
