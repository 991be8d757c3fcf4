// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Ranking/RankingFile.h"

#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/JsonText.h"

#include <cmath>
#include <limits>

namespace excursion {
namespace {

constexpr DocumentFormat rankingFormat {"excursion-ranking"};

using Json = nlohmann::ordered_json;

Quantity quantityIn(const JsonField& field)
{
    const auto quantity = quantityNamed(field.text());
    if (!quantity)
        field.refuse("the name of a quantity");
    return *quantity;
}

/// What ran away is not a number in a document.
double decibelsIn(const JsonField& field)
{
    return field.isNull() ? std::numeric_limits<double>::infinity() : field.number();
}

Json json(const RankedPredistortion& told)
{
    if (!told.trouble.empty())
        return {{"trouble", told.trouble}};
    return {{"beforeDb", numberOrNull(told.beforeDb)},
            {"modelDb", numberOrNull(told.modelDb)},
            {"leftDb", numberOrNull(told.leftDb)},
            {"load", told.load},
            {"latency", told.latency}};
}

RankedPredistortion predistortionIn(const JsonField& object)
{
    RankedPredistortion told;
    told.trouble = object.textIn("trouble");
    if (!told.trouble.empty())
        return told;
    told.beforeDb = decibelsIn(object.at("beforeDb"));
    told.modelDb = decibelsIn(object.at("modelDb"));
    told.leftDb = decibelsIn(object.at("leftDb"));
    told.load = object.at("load").number();
    told.latency = object.at("latency").number();
    return told;
}

Json json(const RankedModel& model)
{
    Json object {{"class", model.name}};
    if (!model.trouble.empty()) {
        object["trouble"] = model.trouble;
        if (!model.kept.empty())
            object["kept"] = model.kept;
        return object;
    }
    object["description"] = model.description;
    object["parameters"] = model.parameters;
    object["estimationDb"] = numberOrNull(model.estimationDb);
    object["validationDb"] = numberOrNull(model.validationDb);
    if (std::isinf(model.validationDb))  // null as well where there are no such records
        object["ranAway"] = true;
    object["load"] = model.load;
    object["fitSeconds"] = model.fitSeconds;
    object["stable"] = model.stable;
    object["linearization"] = json(model.predistortion);
    if (!model.kept.empty())
        object["kept"] = model.kept;
    return object;
}

RankedModel modelIn(const JsonField& object)
{
    RankedModel model;
    model.name = object.at("class").text();
    model.trouble = object.textIn("trouble");
    model.kept = object.textIn("kept");
    if (!model.trouble.empty())
        return model;
    model.description = object.at("description").text();
    model.parameters = object.at("parameters").count(0, std::numeric_limits<int>::max());
    model.estimationDb = decibelsIn(object.at("estimationDb"));
    model.validationDb = object.has("ranAway") && object.at("ranAway").flag() ? std::numeric_limits<double>::infinity()
                                                                              : object.at("validationDb").numberOrNaN();
    model.load = object.at("load").number();
    model.fitSeconds = object.at("fitSeconds").number();
    model.stable = object.at("stable").flag();
    if (object.has("linearization"))
        model.predistortion = predistortionIn(object.at("linearization"));
    else
        model.predistortion.trouble = "It was not tried.";
    return model;
}

}  // namespace

nlohmann::ordered_json toJson(const Ranking& ranking)
{
    Json document = rankingFormat.with(
        {{"take", ranking.take}, {"input", name(ranking.input)}, {"output", name(ranking.output)}});
    document["noiseDb"] = optionalNumber(ranking.noiseDb);
    document["sentence"] = ranking.sentence;
    document["linearizesBest"] = textOrNull(ranking.straightest);
    document["linearizationSentence"] = ranking.straightSentence;
    document["models"] = Json::array();
    for (const auto& model : ranking.models)
        document["models"].push_back(json(model));
    if (!ranking.best.empty())
        document["best"] = ranking.best;
    return document;
}

Ranking rankingFromJson(const JsonField& document)
{
    rankingFormat.require(document);
    Ranking ranking;
    ranking.take = document.textIn("take");
    ranking.input = quantityIn(document.at("input"));
    ranking.output = quantityIn(document.at("output"));
    if (document.has("noiseDb"))
        ranking.noiseDb = document.at("noiseDb").number();
    ranking.sentence = document.at("sentence").text();
    ranking.straightest = document.textIn("linearizesBest");
    ranking.straightSentence = document.textIn("linearizationSentence");
    ranking.best = document.textIn("best");
    for (const auto& model : document.at("models").items())
        ranking.models.push_back(modelIn(model));
    return ranking;
}

}  // namespace excursion
