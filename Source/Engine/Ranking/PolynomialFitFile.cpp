// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Ranking/PolynomialFitFile.h"

#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/JsonText.h"

namespace excursion {
namespace {

constexpr DocumentFormat polynomialFitFormat {"excursion-pnlss-fit"};

using Json = nlohmann::ordered_json;

Json json(const AgreedLaws& laws)
{
    return {{"effects", laws.effects},
            {"baseDb", numberOrNull(laws.baseDb)},
            {"leftDb", numberOrNull(laws.leftDb)},
            {"sentence", laws.sentence}};
}

AgreedLaws lawsIn(const JsonField& object)
{
    AgreedLaws laws;
    for (const auto& effect : object.at("effects").items())
        laws.effects.push_back(effect.text());
    laws.baseDb = object.at("baseDb").numberOrNaN();
    laws.leftDb = object.at("leftDb").numberOrNaN();
    laws.sentence = object.at("sentence").text();
    return laws;
}

}  // namespace

nlohmann::ordered_json toJson(const PolynomialFit& fit)
{
    Json document = polynomialFitFormat.with({{"take", fit.take}});
    document["estimationDb"] = fit.estimationDb;
    document["validationDb"] = numberOrNull(fit.validationDb);
    document["noiseDb"] = optionalNumber(fit.noiseDb);
    document["noiseFrom"] = textOrNull(fit.noiseFrom);
    document["arrived"] = fit.arrived ? Json(*fit.arrived) : Json();
    document["advice"] = textOrNull(fit.advice);
    document["iterations"] = fit.iterations;
    document["stopped"] = fit.stopped;
    document["stable"] = fit.stable;
    document["history"] = numbersOrNulls(fit.history);
    document["laws"] = fit.laws ? json(*fit.laws) : Json();
    document["model"] = fit.model;
    return document;
}

PolynomialFit polynomialFitFromJson(const JsonField& document)
{
    polynomialFitFormat.require(document);
    PolynomialFit fit;
    fit.take = document.at("take").text();
    fit.estimationDb = document.at("estimationDb").numberOrNaN();
    fit.validationDb = document.at("validationDb").numberOrNaN();
    if (document.has("noiseDb"))
        fit.noiseDb = document.at("noiseDb").number();
    fit.noiseFrom = document.textIn("noiseFrom");
    if (document.has("arrived"))
        fit.arrived = document.at("arrived").flag();
    fit.advice = document.textIn("advice");
    fit.iterations = document.at("iterations").count(0, std::numeric_limits<int>::max());
    fit.stopped = document.at("stopped").text();
    fit.stable = document.at("stable").flag();
    fit.history = document.at("history").numbers();
    if (document.has("laws"))
        fit.laws = lawsIn(document.at("laws"));
    fit.model = document.at("model").value();
    return fit;
}

}  // namespace excursion
