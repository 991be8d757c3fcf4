// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/ModelFile.h"

#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Document/Words.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/Curve.h"
#include "Engine/Loudspeaker/Laws.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

using Json = nlohmann::ordered_json;

constexpr DocumentFormat modelFormat {"excursion-model"};

Json parametersJson(const std::vector<Parameter>& parameters)
{
    auto list = Json::array();
    for (const auto& p : parameters)
        list.push_back({{"name", p.name},
                        {"value", p.value},
                        {"unit", p.unit},
                        {"standardError", numberOrNull(p.standardError)},
                        {"free", p.free}});
    return list;
}

Json operatingRangeJson(const OperatingRange& e)
{
    return {{"displacement", e.displacement},
            {"velocity", e.velocity},
            {"current", e.current},
            {"lowFrequency", e.lowFrequency},
            {"highFrequency", e.highFrequency},
            {"degree", e.degree},
            {"scale", e.scale},
            {"duration", e.duration}};
}

Json covarianceJson(const Eigen::MatrixXd& covariance)
{
    if (covariance.size() == 0)
        return nullptr;
    auto rows = Json::array();
    for (Eigen::Index r = 0; r < covariance.rows(); ++r) {
        auto row = Json::array();
        for (Eigen::Index c = 0; c < covariance.cols(); ++c)
            row.push_back(numberOrNull(covariance(r, c)));
        rows.push_back(std::move(row));
    }
    return rows;
}

Json lawsJson(const Model& model)
{
    auto list = Json::array();
    for (const auto& law : laws(model)) {
        list.push_back({{"effect", law.effectId},
                        {"name", law.info.name},
                        {"unit", law.info.unit},
                        {"argument", law.info.argument},
                        {"argumentUnit", law.info.argumentUnit},
                        {"at", curveJson(law.argument)},
                        {"value", curveJson(law.value)},
                        {"halfWidth95", curveJson(law.halfWidth)}});
        if (law.frequency > 0.0)
            list.back()["frequency"] = law.frequency;
    }
    return list;
}

OperatingRange operatingRangeFrom(const JsonField& field)
{
    // Sizes may be in any unit, as a circuit may stand for a driver; their squares and products are still numbers. The
    // bounds of the frequencies keep a file from asking for a ladder of a million cells.
    constexpr double least = 1e-60, most = 1e60;
    OperatingRange e;
    e.displacement = field.at("displacement").numberWithin(least, most);
    e.velocity = field.at("velocity").numberWithin(least, most);
    e.current = field.at("current").numberWithin(least, most);
    e.lowFrequency = field.at("lowFrequency").numberWithin(1e-4, 1e6);
    e.highFrequency = field.at("highFrequency").numberWithin(1e-4, 1e7);
    if (e.highFrequency <= e.lowFrequency)
        field.at("highFrequency").refuse("more than lowFrequency");
    e.degree = field.at("degree").count(1, curve::maximumDegree);
    e.scale = field.at("scale").numberWithin(least, most);
    if (field.has("duration"))  // files of older versions have none
        e.duration = field.at("duration").numberWithin(1e-6, 1e12);
    return e;
}

/// What a file may leave out at the end: departures from a shape, which are zero unless data says otherwise.
bool mayLack(const Parameter& p) { return !p.strength && std::isfinite(p.prior); }

/// Reads values into `known`, which has the names, units and bounds.
std::vector<Parameter> parametersFrom(const JsonField& field, std::vector<Parameter> known)
{
    const auto names = joined(known, [&](const auto& p) { return p.name; });
    const auto items = field.items();
    for (std::size_t k = 0; k < std::max(items.size(), known.size()); ++k) {
        if (k >= items.size() && std::all_of(known.begin() + static_cast<std::ptrdiff_t>(k), known.end(), mayLack)) {
            for (; k < known.size(); ++k)
                known[k].value = 0.0;
            break;
        }
        if (k >= items.size())
            throw Error(Error::Kind::input, "'" + field.source() + "': field '" + field.path()
                                                + "' lacks the parameter '" + known[k].name
                                                + "'; expected are, in this order, " + names + ".");
        if (k >= known.size() || items[k].at("name").text() != known[k].name)
            items[k].at("name").refuse("in this order " + names);
        auto& p = known[k];
        if (items[k].at("unit").text() != p.unit)
            items[k].at("unit").refuse("\"" + p.unit + "\"");
        p.value = items[k].at("value").number();
        // Older fits left joint parameters further out than a fit takes them; the next one brings them back.
        if (!p.joint && (p.value < p.lower || p.value > p.upper))
            p.value = items[k].at("value").numberWithin(p.lower, p.upper);
        p.standardError = items[k].at("standardError").numberOrNaN();
        p.free = items[k].at("free").flag();
    }
    return known;
}

Component componentFrom(const JsonField& field, const Effect& effect, const OperatingRange& operatingRange)
{
    Component component {&effect, operatingRange,
                         parametersFrom(field.at("parameters"), effect.parameters(operatingRange))};
    component.operatingRange.relaxed = std::any_of(component.parameters.begin(), component.parameters.end(),
                                                   [](const Parameter& p) { return p.relaxed && p.value != 0.0; });
    return component;
}

const Effect& effectFrom(const JsonField& field, const Model& model)
{
    std::vector<std::string> known;
    for (const auto* effect : catalogue())
        known.push_back(effect->id());
    const auto& effect = effectNamed(field.oneOf(known));
    if (model.has(effect.id()))
        field.refuse("every effect only once");
    if (effect.electrical() && !model.electrical())
        field.refuse("no electrical effect, as this driver has no coil");
    return effect;
}

/// The places of the parameters that a file gives: older ones lack departures at the ends.
std::vector<Eigen::Index> placesGiven(const JsonField& field, const Model& model)
{
    std::vector<Eigen::Index> places;
    const auto add = [&](const JsonField& component, std::size_t k) {
        const auto first = firstParameterOf(model, k);
        for (std::size_t j = 0; j < component.at("parameters").items().size(); ++j)
            places.push_back(first + static_cast<Eigen::Index>(j));
    };
    add(field.at("base"), 0);
    std::size_t k = 0;
    for (const auto& item : field.at("effects").items())
        add(item, ++k);
    add(field.at("path"), ++k);
    return places;
}

/// @param given  places of the parameters that the file gives; zero beside the others
Eigen::MatrixXd covarianceFrom(const JsonField& field, const std::vector<Eigen::Index>& given, Eigen::Index size)
{
    if (field.isNull())
        return {};
    const auto count = given.size();
    const auto expected = "null or " + std::to_string(count) + " rows of " + std::to_string(count)
                          + " numbers, one a parameter of the model";
    const auto rows = field.items();
    if (rows.size() != count)
        field.refuse(expected);
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size, size);
    for (std::size_t r = 0; r < count; ++r) {
        const auto& row = rows[r];
        const auto values = row.numbers();
        if (values.size() != count)
            row.refuse(expected);
        for (std::size_t c = 0; c < count; ++c)
            covariance(given[r], given[c]) = values[c];
        if (covariance(given[r], given[r]) < 0)
            row.refuse("a variance of at least 0 on the diagonal");
    }
    return covariance;
}

}  // namespace

Json toJson(const Model& model)
{
    Json document = modelFormat.with({{"name", model.name}});
    document["base"] = {{"id", model.base().effect->id()}, {"parameters", parametersJson(model.base().parameters)}};
    document["effects"] = Json::array();
    for (std::size_t k = 1; k < model.components.size(); ++k) {
        const auto& c = model.components[k];
        document["effects"].push_back({{"id", c.effect->id()},
                                       {"operatingRange", operatingRangeJson(c.operatingRange)},
                                       {"parameters", parametersJson(c.parameters)}});
    }
    document["path"] = {{"parameters", parametersJson(model.path.parameters)},
                        {"microphoneDistance", model.microphoneDistance}};
    document["covariance"] = covarianceJson(model.covariance);
    document["laws"] = lawsJson(model);
    return document;
}

Model modelFromJson(const JsonField& field)
{
    modelFormat.require(field);
    const auto base = field.at("base");
    auto model = makeModel(base.at("id").oneOf({electrodynamicBase().id(), mechanicalBase().id()}));
    model.name = field.at("name").text();
    model.components.front() = componentFrom(base, *model.base().effect, {});
    for (std::size_t k = 0; k < model.base().parameters.size(); ++k)
        if (model.base().parameters[k].name == "m" && model.base().parameters[k].value <= 0.0)
            base.at("parameters").items()[k].at("value").refuse("a mass above 0 kg");
    for (const auto& item : field.at("effects").items()) {
        const auto& effect = effectFrom(item.at("id"), model);
        model.components.push_back(
            componentFrom(item, effect, operatingRangeFrom(item.at("operatingRange", "extent"))));
    }
    for (auto& component : model.components)
        component.operatingRange.joint = sharesBase(model, *component.effect);
    // Older files do not tell the scale of what creeps; they have a 1 there, and are written again as they were read.
    constexpr double untold = 1.0;
    for (std::size_t k = 1; k < model.components.size(); ++k)
        if (auto& scale = model.components[k].operatingRange.scale;
            model.components[k].effect->creeps() && scale == untold) {
            resize(model, k);
            scale = untold;
        }
    const auto path = field.at("path");
    model.path.parameters = parametersFrom(path.at("parameters"), model.path.parameters);
    model.microphoneDistance = path.at("microphoneDistance").numberWithin(1e-6, 1e6);
    tellHosts(model);
    model.covariance = covarianceFrom(field.at("covariance"), placesGiven(field, model), parameterVector(model).size());
    return model;
}

Model modelFromJson(const nlohmann::json& document, const std::string& where)
{
    return modelFromJson(JsonField(document, "", where));
}

Model readModel(const std::filesystem::path& path)
{
    const auto document = readJson(path);
    return modelFromJson(document, path.string());
}

void writeModel(const Model& model, const std::filesystem::path& path) { writeJson(toJson(model), path); }

}  // namespace excursion
