// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/LadderFile.h"

#include "Engine/Design/WhatIfFile.h"
#include "Engine/Diagnosis/ComparisonFile.h"
#include "Engine/Diagnosis/DiagnosisFile.h"
#include "Engine/Diagnosis/RemainderFile.h"
#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Loudspeaker/ModelFile.h"

#include <algorithm>

namespace excursion {
namespace {

using Json = nlohmann::ordered_json;

constexpr DocumentFormat ladderFormat {"excursion-ladder"};

Json parametersJson(const Model& model)
{
    auto list = Json::array();
    const auto add = [&list](const std::string& of, const std::vector<Parameter>& parameters) {
        for (const auto& p : parameters)
            list.push_back({{"of", of},
                            {"name", p.name},
                            {"value", numberOrNull(p.value)},
                            {"unit", p.unit},
                            {"standardError", numberOrNull(p.standardError)}});
    };
    for (const auto& component : model.components)
        add(component.effect->id(), component.parameters);
    add(model.path.effect->id(), model.path.parameters);
    return list;
}

Json levelsJson(const Comparison& comparison)
{
    auto list = Json::array();
    for (std::size_t k = 0; k < comparison.levels.size(); ++k) {
        ErrorByChannel errors;
        for (const auto& channel : comparison.channels)
            if (k < channel.byLevel.size())
                errors[channel.quantity] = channel.byLevel[k];
        list.push_back({{"rms", numberOrNull(comparison.levels[k])}, {"error", toJson(errors)}});
    }
    return list;
}

Json fitJson(const FitSummary& fit)
{
    return {{"usable", fit.usable()},       {"converged", fit.converged()},
            {"iterations", fit.iterations}, {"reason", fit.message},
            {"substeps", fit.substeps},     {"chiSquaredPerValue", numberOrNull(fit.chiSquaredPerValue)}};
}

FitSummary fitFrom(const JsonField& field)
{
    constexpr int most = 1000000;
    FitSummary fit;
    const bool usable = field.at("usable").flag(), converged = field.at("converged").flag();
    fit.termination = !usable     ? Termination::brokeDown
                      : converged ? Termination::costSettled
                                  : Termination::maximumIterations;
    fit.iterations = field.at("iterations").count(0, most);
    fit.message = field.at("reason").text();
    fit.substeps = field.at("substeps").count(0, most);
    fit.chiSquaredPerValue = field.at("chiSquaredPerValue", "costPerResidual").numberOrNaN();
    return fit;
}

Json rungJson(const Rung& rung, const Rung* before)
{
    Json document {{"added", rung.added.empty() ? Json(nullptr) : Json(rung.added)}};
    document["errorBefore"] = before ? toJson(errorByChannel(before->comparison)) : Json(nullptr);
    document["predictedErrorDb"] = rung.added.empty() ? Json(nullptr) : toJson(rung.predictedErrorDb);
    document["error"] = toJson(errorByChannel(rung.comparison));
    document["levels"] = levelsJson(rung.comparison);
    document["parameters"] = parametersJson(rung.model);
    document["fit"] = fitJson(rung.fit);
    document["diagnosis"] = toJson(rung.diagnosis);
    document["comparison"] = toJson(rung.comparison);
    document["model"] = toJson(rung.model);
    return document;
}

Rung rungFrom(const JsonField& field)
{
    Rung rung;
    if (field.has("added"))
        rung.added = field.at("added").text();
    if (field.has("predictedErrorDb"))
        rung.predictedErrorDb = decibelsFromJson(field.at("predictedErrorDb"));
    rung.comparison = comparisonFromJson(field.at("comparison"));
    rung.diagnosis = diagnosisFromJson(field.at("diagnosis"));
    rung.model = modelFromJson(field.at("model"));
    rung.fit = fitFrom(field.at("fit"));
    return rung;
}

Json knownJson(const Ladder& ladder)
{
    auto list = Json::array();
    for (const auto& known : knownEffects(ladder))
        list.push_back({{"effect", known.effect}, {"confidence", optionalNumber(known.confidence)}});
    return list;
}

Json takeJson(const TakeSummary& take)
{
    return {{"path", take.path},
            {"driver", take.driver},
            {"sampleRate", take.sampleRate},
            {"seconds", take.seconds},
            {"channels", take.channels},
            {"levels", numbersOrNulls(take.levels)},
            {"realizations", take.realizations},
            {"periods", take.periods}};
}

TakeSummary takeFrom(const JsonField& field)
{
    constexpr int most = 1000000000;
    TakeSummary take;
    take.path = field.at("path").text();
    take.driver = field.at("driver").text();
    take.sampleRate = field.at("sampleRate").number();
    take.seconds = field.at("seconds").number();
    take.channels = textsFromJson(field.at("channels"));
    take.levels = field.at("levels").numbers();
    take.realizations = field.at("realizations").count(0, most);
    take.periods = field.at("periods").count(0, most);
    return take;
}

Json responseJson(const ResponseTarget& response)
{
    std::vector<double> re, im;
    for (const auto& value : response.value) {
        re.push_back(value.real());
        im.push_back(value.imag());
    }
    return {{"quantity", name(response.quantity)},
            {"impedance", response.impedance},
            {"frequency", curveJson(response.frequency)},
            {"re", curveJson(re)},
            {"im", curveJson(im)},
            {"deviation", curveJson(response.deviation)}};
}

ResponseTarget responseFrom(const JsonField& field)
{
    ResponseTarget response;
    response.quantity = quantityFromJson(field.at("quantity"));
    response.impedance = field.at("impedance").flag();
    response.frequency = field.at("frequency").numbers();
    const auto re = field.at("re").numbers(), im = field.at("im").numbers();
    response.deviation = field.at("deviation").numbers();
    if (re.size() != response.frequency.size() || im.size() != re.size())
        field.at("re").refuse("as many numbers as there are frequencies, " + std::to_string(response.frequency.size()));
    for (std::size_t k = 0; k < re.size(); ++k)
        response.value.emplace_back(re[k], im[k]);
    return response;
}

/// An admittance is shown as the impedance that everybody knows.
ResponseTarget asImpedance(ResponseTarget response)
{
    if (response.quantity != Quantity::current || response.impedance)
        return response;
    response.impedance = true;
    for (std::size_t k = 0; k < response.value.size(); ++k) {
        const double size = std::norm(response.value[k]);
        response.value[k] = size > 0.0 ? 1.0 / response.value[k] : 0.0;
        if (k < response.deviation.size())
            response.deviation[k] = size > 0.0 ? response.deviation[k] / size : 0.0;
    }
    return response;
}

std::optional<WhatIf> whatIfOn(const Model& model, const Record& record, const Progress& progress)
{
    if (std::all_of(model.components.begin(), model.components.end(),
                    [](const Component& c) { return c.effect->linear(); }))
        return std::nullopt;
    try {
        return whatIf(model, record, progress);
    } catch (const Error& e) {
        if (e.kind() != Error::Kind::numerical)
            throw;
        return std::nullopt;  // the ladder stands without it
    }
}

}  // namespace

TakeSummary summarize(const PreparedTake& take, const std::string& path)
{
    TakeSummary summary;
    summary.path = path;
    if (const auto* measurement = take.inTime()) {
        summary.driver = measurement->driver.name;
        summary.sampleRate = measurement->sampleRate;
        summary.seconds = static_cast<double>(measurement->length()) / measurement->sampleRate;
        for (const auto& channel : measurement->channels)
            summary.channels.emplace_back(name(channel.quantity));
        if (measurement->excitation) {
            summary.levels = measurement->excitation->levels;
            summary.realizations = measurement->excitation->realizations;
            summary.periods = measurement->excitation->periods;
        }
    } else {
        const auto& spectra = *take.asResponses();
        summary.driver = spectra.driver.name;
        for (const auto& channel : spectra.channels)
            summary.channels.emplace_back(name(channel.quantity));
    }
    return summary;
}

std::optional<WhatIf> whatIfOf(const Model& model, const PreparedTake& take, const Progress& progress)
{
    return take.inTime() ? whatIfOn(model, take.record(), progress) : std::nullopt;
}

LadderFile makeLadderFile(Ladder ladder, const PreparedTake& take, const std::string& path)
{
    LadderFile file;
    file.take = summarize(take, path);
    if (!ladder.rungs.empty()) {
        if (take.inTime()) {
            const auto& record = take.record();
            file.responses = responsesOf(record, record.levels.empty() ? -1 : 0, 24);
            file.whatIf = whatIfOn(ladder.model(), record, {});
        } else {
            file.responses = responsesOf(*take.asResponses());
        }
        for (auto& response : file.responses)
            response = asImpedance(std::move(response));
    }
    file.ladder = std::move(ladder);
    return file;
}

Json toJson(const LadderFile& file)
{
    Json document = ladderFormat.with(
        {{"verdict", name(file.ladder.verdict)},
         {"sentence", file.ladder.sentence},
         {"problems", toJson(file.ladder.problems)},
         {"withdrawn", file.ladder.withdrawn},
         {"known", knownJson(file.ladder)},
         {"remainder",
          file.ladder.rungs.empty() ? Json(nullptr) : toJson(file.ladder.rungs.back().diagnosis.remainder)},
         {"take", takeJson(file.take)}});
    document["rungs"] = Json::array();
    for (std::size_t k = 0; k < file.ladder.rungs.size(); ++k)
        document["rungs"].push_back(rungJson(file.ladder.rungs[k], k > 0 ? &file.ladder.rungs[k - 1] : nullptr));
    document["responses"] = Json::array();
    for (const auto& response : file.responses)
        document["responses"].push_back(responseJson(response));
    document["whatIf"] = file.whatIf ? toJson(*file.whatIf) : Json(nullptr);
    return document;
}

LadderFile ladderFromJson(const nlohmann::json& document, const std::string& where)
{
    const JsonField root(document, "", where);
    ladderFormat.require(root);
    LadderFile file;
    file.ladder.verdict = verdictFromJson(root.at("verdict"));
    file.ladder.sentence = root.at("sentence").text();
    file.ladder.problems = problemsFromJson(root.at("problems"));
    file.ladder.withdrawn = textsFromJson(root.at("withdrawn"));
    file.take = takeFrom(root.at("take"));
    for (const auto& rung : root.at("rungs").items())
        file.ladder.rungs.push_back(rungFrom(rung));
    for (const auto& response : root.at("responses").items())
        file.responses.push_back(responseFrom(response));
    if (root.has("whatIf"))  // ladders of before have none
        file.whatIf = whatIfFromJson(root.at("whatIf"));
    return file;
}

LadderFile readLadder(const std::filesystem::path& path) { return ladderFromJson(readJson(path), path.string()); }

void writeLadder(const LadderFile& file, const std::filesystem::path& path) { writeJson(toJson(file), path); }

}  // namespace excursion
