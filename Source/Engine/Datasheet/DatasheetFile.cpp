// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Datasheet/DatasheetFile.h"

#include "Engine/Datasheet/Impedances.h"
#include "Engine/Design/WhatIfFile.h"
#include "Engine/Document/CsvText.h"
#include "Engine/Document/Figures.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Loudspeaker/Network.h"

namespace excursion {
namespace {

using Json = nlohmann::ordered_json;

Json inductanceJson(const LossyInductance& inductance)
{
    Json document {{"band", {inductance.low, inductance.high}},
                   {"Re", inductance.Re},
                   {"lossless", inductance.lossless},
                   {"Le", inductance.lossless ? Json(inductance.Le) : Json(nullptr)}};
    document["forms"] = Json::array();
    for (const auto& form : inductance.forms) {
        Json parameters = Json::array();
        for (const auto& p : form.parameters)
            parameters.push_back({{"name", p.name}, {"value", p.value}, {"unit", p.unit}});
        document["forms"].push_back({{"id", form.id},
                                     {"formula", form.formula},
                                     {"parameters", std::move(parameters)},
                                     {"errorPercent", form.errorPercent},
                                     {"worstDb", form.worstDb}});
    }
    return document;
}

std::vector<std::string> remarksOn(const ScaledModel& given)
{
    const auto& model = given.model;
    std::vector<std::string> remarks;
    if (given.motionIsGuessed)
        remarks.emplace_back("Voltage and current alone show Bl^2/Mms, Rms/Mms and 1/(Cms Mms): with a known moving "
                             "mass or force factor the rest can be said.");
    if (model.electrical() && !given.areaIsGuessed && !model.path.parameters[0].free)
        remarks.emplace_back("The area of the cone was given, and has no error here.");
    if (const double at = model.electrical() ? resistanceFrequency(model) : 0.0; at > 0.0)
        remarks.emplace_back(
            "Re is the resistance of the blocked coil at " + frequencyText(at)
            + ", the lowest frequency of the take: below it the take does not tell Re from losses in the iron.");
    constexpr double sheetFrequency = 1000.0;
    if (model.electrical() && bandOf(model).second < sheetFrequency)
        remarks.emplace_back("The model was measured below 1 kHz: there Le is a guess.");
    for (const auto& component : model.components) {
        const auto* parts = networkPartsOf(*component.effect);
        if (parts && parts->ofEnclosure() && isAtWork(component))
            remarks.emplace_back("Measured in a box, whose parts are left out: the moving mass has the air of the box "
                                 "on it, and the compliance is that of the "
                                 "suspension with what of the box acts on a cone at rest.");
        if (parts && component.effect->creeps() && isAtWork(component))
            remarks.emplace_back("The suspension creeps: Cms and Rms are those at fs; more slowly it is softer.");
    }
    return remarks;
}

}  // namespace

Datasheet datasheetOf(const ScaledModel& given, double bandLow, double bandHigh, int lawPoints)
{
    Datasheet sheet;
    sheet.driver = given.model.name;
    sheet.thieleSmall = thieleSmall(given);
    if (given.model.electrical())
        sheet.inductance = lossyInductance(given.model, bandLow, bandHigh);
    sheet.laws = lawTables(given, lawPoints);
    if (!given.motionIsGuessed)
        sheet.stroke = strokeLimits(given.model);
    sheet.remarks = remarksOn(given);
    return sheet;
}

Json toJson(const Datasheet& sheet)
{
    Json document {{"driver", sheet.driver}};
    document["thieleSmall"] = Json::array();
    for (const auto& f : sheet.thieleSmall)
        document["thieleSmall"].push_back({{"symbol", f.symbol},
                                           {"value", numberOrNull(f.value)},
                                           {"unit", f.unit},
                                           {"standardError", numberOrNull(f.standardError)},
                                           {"sheetValue", numberOrNull(f.value * f.perUnit)},
                                           {"sheetUnit", f.sheetUnit},
                                           {"meaning", f.meaning},
                                           {"why", f.why.empty() ? Json(nullptr) : Json(f.why)}});
    document["inductance"] = sheet.inductance ? inductanceJson(*sheet.inductance) : Json(nullptr);
    document["laws"] = Json::array();
    for (const auto& law : sheet.laws) {
        document["laws"].push_back({{"name", law.name},
                                    {"unit", law.unit},
                                    {"argument", law.argument},
                                    {"argumentUnit", law.argumentUnit},
                                    {"at", numbersOrNulls(law.at)},
                                    {"value", numbersOrNulls(law.value)},
                                    {"low95", numbersOrNulls(law.low95)},
                                    {"high95", numbersOrNulls(law.high95)}});
        if (law.frequency > 0.0)
            document["laws"].back()["frequency"] = law.frequency;
    }
    document["stroke"] = sheet.stroke ? toJson(*sheet.stroke) : Json(nullptr);
    document["remarks"] = sheet.remarks;
    return document;
}

std::string parametersCsv(const Datasheet& sheet)
{
    std::string text = "symbol,value,standard_error,unit,remark\n";
    for (const auto& f : sheet.thieleSmall)
        text += f.symbol + "," + csvNumber(f.value * f.perUnit) + "," + csvNumber(f.standardError * f.perUnit) + ","
                + f.sheetUnit + "," + csvText(f.why.empty() ? f.meaning : "unknown: " + f.why) + "\n";
    if (!sheet.inductance)
        return text;
    for (const auto& form : sheet.inductance->forms) {
        for (const auto& p : form.parameters)
            text += form.id + " " + p.name + "," + csvNumber(p.value) + ",," + p.unit + "," + csvText(form.formula)
                    + "\n";
        text += form.id + " error," + csvNumber(form.errorPercent) + ",,%,"
                + csvText("rms of |Z - Z_model|/|Z_model| from " + csvNumber(sheet.inductance->low) + " to "
                          + csvNumber(sheet.inductance->high) + " Hz")
                + "\n";
    }
    return text;
}

std::string lawsCsv(const Datasheet& sheet)
{
    std::string text = "law,argument,argument_unit,at,value,low_95,high_95,unit,frequency\n";
    for (const auto& law : sheet.laws)
        for (std::size_t k = 0; k < law.at.size(); ++k)
            text += law.name + "," + law.argument + "," + law.argumentUnit + "," + csvNumber(law.at[k]) + ","
                    + csvNumber(law.value[k]) + "," + csvNumber(law.low95[k]) + "," + csvNumber(law.high95[k]) + ","
                    + law.unit + "," + (law.frequency > 0.0 ? csvNumber(law.frequency) : std::string()) + "\n";
    if (!sheet.stroke)
        return text;
    for (const auto& limit : sheet.stroke->limits)
        for (const int side : {-1, 1}) {
            const auto place = side < 0 ? limit.inward : limit.outward;
            text += "limit," + csvText(limit.name + " " + limit.criterion) + ",m,"
                    + (place ? csvNumber(side * *place) : std::string()) + ","
                    + csvNumber(side < 0 ? limit.inwardEnd : limit.outwardEnd) + ",,,% at the end of the range,\n";
        }
    return text;
}

}  // namespace excursion
