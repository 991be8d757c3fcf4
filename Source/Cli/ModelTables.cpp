// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/ModelTables.h"

#include "Cli/Terminal.h"
#include "Engine/Diagnosis/ComparisonFile.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Document/Words.h"
#include "Engine/Loudspeaker/Laws.h"
#include "Engine/Loudspeaker/SensorResponse.h"
#include "Engine/Loudspeaker/Summary.h"

#include <algorithm>
#include <cmath>

namespace excursion::cli {
namespace {

using Rows = std::vector<std::vector<std::string>>;

/// As many decimals as show the second digit of the error, so that no digit is shown that is not known.
int decimalsFor(double value, double error)
{
    const double size = std::isfinite(error) && error > 0.0 ? 0.1 * error : 1e-4 * std::abs(value);
    return size > 0.0 ? std::clamp(static_cast<int>(std::ceil(-std::log10(size))), 0, 7) : 0;
}

void addRows(Rows& rows, const std::vector<Parameter>& parameters)
{
    for (const auto& p : parameters) {
        const auto unit = displayUnit(std::abs(p.value), p.unit);
        const double value = p.value * unit.factor, error = p.standardError * unit.factor;
        const int decimals = decimalsFor(value, p.free ? error : 0.0);
        rows.push_back({p.name, fixed(value, decimals), p.free && std::isfinite(error) ? fixed(error, decimals) : "-",
                        unit.unit, p.free ? "" : "held: this take cannot see it"});
    }
}

void addRows(Rows& rows, const std::vector<Figure>& figures)
{
    for (const auto& figure : figures) {
        const int decimals = decimalsFor(figure.value, figure.standardError);
        rows.push_back({figure.name, fixed(figure.value, decimals),
                        std::isfinite(figure.standardError) ? fixed(figure.standardError, decimals) : "-", figure.unit,
                        ""});
    }
}

}  // namespace

void printParameters(const Model& model, Terminal& terminal)
{
    Rows rows;
    for (std::size_t k = 0; k < model.components.size(); ++k) {
        const auto& component = model.components[k];
        if (const auto figures = figuresOf(model, k); !figures.empty())
            addRows(rows, figures);
        // a law is better read as the curve than as the coefficients of its expansion
        else if (!component.effect->law())
            addRows(rows, component.parameters);
    }
    addRows(rows, toldOfPath(model));
    const bool held = std::any_of(rows.begin(), rows.end(), [](const auto& row) { return !row.back().empty(); });
    terminal.table({"parameter", "value", "std error", "unit", held ? "remark" : ""}, rows);
    std::vector<LawTable> tables;
    for (const auto& law : laws(model))
        tables.push_back(tableOf(law));
    printLaws(tables, terminal);
}

void printLaws(const std::vector<LawTable>& laws, Terminal& terminal)
{
    Rows rows;
    for (const auto& law : laws) {
        const auto largest = std::max_element(law.value.begin(), law.value.end(),
                                              [](double a, double b) { return std::abs(a) < std::abs(b); });
        const auto unit = displayUnit(std::abs(*largest), law.unit),
                   argument = displayUnit(law.at.back(), law.argumentUnit);
        const auto at = [&](std::size_t k) {
            const double half = 0.5 * (law.high95[k] - law.low95[k]) * unit.factor;
            return significant(law.value[k] * unit.factor)
                   + (std::isfinite(half) ? " \u00b1 " + significant(half, 2) : std::string());
        };
        rows.push_back({titleOfLaw(law.name, law.frequency), at(0), at(law.at.size() / 2), at(law.at.size() - 1),
                        unit.unit,
                        law.argument + " = " + significant(law.at.back() * argument.factor, 3) + " " + argument.unit});
    }
    if (rows.empty())
        return;
    terminal.say("");
    terminal.table({"law", "at -end", "at rest", "at +end", "unit", "end"}, rows);
    terminal.say("\u00b1: half of the 95 % band.");
}

void printLimits(const StrokeLimits& stroke, Terminal& terminal)
{
    const auto place = [](const std::optional<double>& metres, double atEnd) {
        return metres ? significant(1e3 * *metres, 3) + " mm" : "not reached (" + significant(atEnd, 3) + " %)";
    };
    Rows rows;
    for (const auto& limit : stroke.limits)
        rows.push_back({limit.name + " " + limit.criterion, place(limit.inward, limit.inwardEnd),
                        place(limit.outward, limit.outwardEnd)});
    terminal.table({"limit of the stroke", "inward", "outward"}, rows);
}

void printErrors(const Comparison& comparison, Terminal& terminal)
{
    Rows rows;
    for (const auto& channel : comparison.channels)
        rows.push_back({titleOf(channel), fixed(channel.total.db, 1), decibelText(channel.total.noiseFloorDb),
                        chiSquaredText(channel.total.chiSquaredPerValue, comparison.noiseKnown)});
    terminal.table({"channel", "error dB", "noise dB", chiSquaredTitle}, rows);
    terminal.say(wrapped(
        std::string("Error and noise are rms relative to the channel, on ")
        + (comparison.validated ? "data that no fit saw" : "the data that was fitted, as nothing could be held out")
        + (comparison.noiseKnown ? ". \u03c7\u00b2/value: mean of squared error over squared noise, 1 at best."
                                 : ". The take does not tell its noise.")));
}

std::string decibelText(const std::optional<double>& db)
{
    return db && std::isfinite(*db) ? fixed(*db, 1) : std::string("-");
}

std::string chiSquaredText(double chiSquaredPerValue, bool noiseKnown)
{
    return !noiseKnown                 ? std::string("-")
           : chiSquaredPerValue < 9.95 ? fixed(chiSquaredPerValue, 1)
           : chiSquaredPerValue < 1e6  ? fixed(chiSquaredPerValue, 0)
                                       : significant(chiSquaredPerValue, 2);
}

std::string confidenceText(double confidence) { return fixed(std::min(99.0, 100.0 * confidence), 0) + " %"; }

std::string effectsText(const Model& model)
{
    const auto text = joined(model.effectIds());
    return text.empty() ? "the base alone, which is linear" : "the base and " + text;
}

nlohmann::ordered_json modelJson(const Model& model, const Comparison& comparison, const FitSummary& fit)
{
    nlohmann::ordered_json document {{"effects", model.effectIds()},
                                     {"error", toJson(errorByChannel(comparison))},
                                     {"noiseKnown", comparison.noiseKnown},
                                     {"validated", comparison.validated}};
    document["parameters"] = nlohmann::ordered_json::array();
    const auto add = [&document](const std::string& of, const std::vector<Parameter>& parameters) {
        for (const auto& p : parameters)
            document["parameters"].push_back({{"of", of},
                                              {"name", p.name},
                                              {"value", p.value},
                                              {"unit", p.unit},
                                              {"standardError", numberOrNull(p.standardError)},
                                              {"free", p.free}});
    };
    for (const auto& component : model.components)
        add(component.effect->id(), component.parameters);
    add(model.path.effect->id(), model.path.parameters);
    document["summary"] = nlohmann::ordered_json::array();
    for (std::size_t k = 0; k < model.components.size(); ++k)
        for (const auto& figure : figuresOf(model, k))
            document["summary"].push_back({{"of", model.components[k].effect->id()},
                                           {"name", figure.name},
                                           {"value", figure.value},
                                           {"unit", figure.unit},
                                           {"standardError", numberOrNull(figure.standardError)}});
    document["fit"] = {{"converged", fit.converged()},
                       {"iterations", fit.iterations},
                       {"reason", fit.message},
                       {"substeps", fit.substeps}};
    return document;
}

}  // namespace excursion::cli
