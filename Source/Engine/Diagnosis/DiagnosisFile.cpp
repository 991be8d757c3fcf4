// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/DiagnosisFile.h"

#include "Engine/Diagnosis/ComparisonFile.h"
#include "Engine/Diagnosis/RemainderFile.h"
#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/JsonText.h"

#include <array>

namespace excursion {
namespace {

using Json = nlohmann::ordered_json;

constexpr DocumentFormat diagnosisFormat {"excursion-diagnosis"};

Json rankedJson(const RankedEffect& ranked)
{
    const bool tried = !ranked.confirmedErrorDb.empty();
    return {{"effect", ranked.effect},
            {"confidence", numberOrNull(ranked.confidence)},
            {"predictedErrorDb", toJson(ranked.predictedErrorDb)},
            {"confirmedErrorDb", tried ? toJson(ranked.confirmedErrorDb) : Json(nullptr)},
            {"predictedChiSquaredPerValue", numberOrNull(ranked.predictedChiSquaredPerValue)},
            {"confirmedChiSquaredPerValue", tried ? numberOrNull(ranked.confirmedChiSquaredPerValue) : Json(nullptr)},
            {"uniqueDb", numberOrNull(ranked.vote.uniqueDb)},
            {"inconsistency", numberOrNull(ranked.vote.inconsistency)},
            {"significant", ranked.significant},
            {"reason", ranked.reason}};
}

RankedEffect rankedFrom(const JsonField& field)
{
    RankedEffect ranked;
    ranked.effect = field.at("effect").text();
    ranked.confidence = field.at("confidence").numberOrNaN();
    ranked.predictedErrorDb = decibelsFromJson(field.at("predictedErrorDb"));
    ranked.predictedChiSquaredPerValue = field.at("predictedChiSquaredPerValue", "predictedChi").numberOrNaN();
    if (field.has("confirmedErrorDb")) {
        ranked.confirmedErrorDb = decibelsFromJson(field.at("confirmedErrorDb"));
        ranked.confirmedChiSquaredPerValue = field.at("confirmedChiSquaredPerValue", "confirmedChi").numberOrNaN();
    }
    if (field.has("uniqueDb"))  // not told of a frequency response, nor by files from before
        ranked.vote.uniqueDb = field.at("uniqueDb").numberOrNaN();
    if (field.has("inconsistency"))
        ranked.vote.inconsistency = field.at("inconsistency").numberOrNaN();
    ranked.significant = field.at("significant").flag();
    ranked.reason = field.at("reason").text();
    return ranked;
}

}  // namespace

Json toJson(const std::vector<Problem>& problems)
{
    auto list = Json::array();
    for (const auto& p : problems)
        list.push_back({{"kind", p.kind},
                        {"channel", p.channel ? Json(name(*p.channel)) : Json(nullptr)},
                        {"value", numberOrNull(p.value)},
                        {"unit", p.unit},
                        {"fatal", p.fatal},
                        {"sentence", p.sentence}});
    return list;
}

std::vector<Problem> problemsFromJson(const JsonField& field)
{
    std::vector<Problem> problems;
    for (const auto& item : field.items()) {
        Problem p;
        p.kind = item.at("kind").text();
        if (item.has("channel"))
            p.channel = quantityFromJson(item.at("channel"));
        p.value = item.at("value").numberOrNaN();
        p.unit = item.at("unit").text();
        p.fatal = item.at("fatal").flag();
        p.sentence = item.at("sentence").text();
        problems.push_back(std::move(p));
    }
    return problems;
}

Verdict verdictFromJson(const JsonField& field)
{
    constexpr std::array verdicts {Verdict::missingEffect, Verdict::complete, Verdict::unknownEffect,
                                   Verdict::badMeasurement};
    std::vector<std::string> known;
    for (const auto verdict : verdicts)
        known.emplace_back(name(verdict));
    const auto found = field.oneOf(known);
    for (const auto verdict : verdicts)
        if (name(verdict) == found)
            return verdict;
    return Verdict::unknownEffect;
}

std::vector<std::string> textsFromJson(const JsonField& field)
{
    std::vector<std::string> texts;
    for (const auto& item : field.items())
        texts.push_back(item.text());
    return texts;
}

Json toJson(const Diagnosis& diagnosis)
{
    Json document = diagnosisFormat.with(
        {{"verdict", name(diagnosis.verdict)}, {"sentence", diagnosis.sentence}, {"error", toJson(diagnosis.error)}});
    document["ranking"] = Json::array();
    for (const auto& ranked : diagnosis.ranking)
        document["ranking"].push_back(rankedJson(ranked));
    document["indistinguishable"] = diagnosis.indistinguishable;
    document["measureNext"] = diagnosis.measureNext;
    document["remainder"] = toJson(diagnosis.remainder);
    document["problems"] = toJson(diagnosis.problems);
    return document;
}

Diagnosis diagnosisFromJson(const JsonField& field)
{
    diagnosisFormat.require(field);
    Diagnosis diagnosis;
    diagnosis.verdict = verdictFromJson(field.at("verdict"));
    diagnosis.sentence = field.at("sentence").text();
    diagnosis.error = errorByChannelFromJson(field.at("error"));
    for (const auto& item : field.at("ranking").items())
        diagnosis.ranking.push_back(rankedFrom(item));
    diagnosis.indistinguishable = textsFromJson(field.at("indistinguishable"));
    diagnosis.measureNext = field.at("measureNext").text();
    if (field.has("remainder"))  // files from before have none
        diagnosis.remainder = remainderFromJson(field.at("remainder"));
    diagnosis.problems = problemsFromJson(field.at("problems"));
    return diagnosis;
}

}  // namespace excursion
