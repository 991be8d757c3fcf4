// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"
#include "Cli/ModelTables.h"
#include "Cli/OpenTake.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"

#include "Engine/Diagnosis/ComparisonFile.h"
#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Loudspeaker/ModelFile.h"
#include "Engine/Loudspeaker/Seen.h"
#include "Engine/Upkeep/Adaptation.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <memory>

namespace excursion::cli {
namespace {

struct AdaptArguments {
    std::string model, take, out;
    std::vector<std::string> parameters;
};

std::vector<std::string> rowOf(const Drifted& one)
{
    const auto unit = displayUnit(std::abs(one.before), one.unit == "1" ? "" : one.unit);
    const auto error = [&unit](double value) {
        return std::isfinite(value) ? significant(value * unit.factor, 2) : std::string("-");
    };
    const double sure = one.certainty();
    return {one.name,
            significant(one.before * unit.factor, 5),
            error(one.beforeError),
            significant(one.after * unit.factor, 5),
            error(one.afterError),
            unit.unit,
            fixed(100.0 * one.share(), 2) + " %",
            std::isfinite(sure) ? significant(sure, 2) : "-"};
}

nlohmann::ordered_json documentOf(const std::vector<Drifted>& all)
{
    auto items = nlohmann::ordered_json::array();
    for (const auto& one : all)
        items.push_back({{"name", one.name},
                         {"unit", one.unit},
                         {"before", one.before},
                         {"beforeError", numberOrNull(one.beforeError)},
                         {"after", one.after},
                         {"afterError", numberOrNull(one.afterError)}});
    return items;
}

void print(const Adaptation& adapted, Terminal& terminal)
{
    const auto& drift = adapted.drift;
    std::vector<std::vector<std::string>> rows;
    for (const auto* group : {&drift.parameters, &drift.figures})
        for (const auto& one : *group)
            rows.push_back(rowOf(one));
    terminal.table({"parameter", "was", "std error", "is", "std error", "unit", "change", "in errors"}, rows);
    if (drift.warmer)
        terminal.say("A copper coil with this Re is " + fixed(std::abs(*drift.warmer), 1) + " K "
                     + (*drift.warmer >= 0.0 ? "warmer" : "colder") + " than it was"
                     + (drift.warmerError ? " (\u00b1 " + significant(*drift.warmerError, 2) + " K)" : "") + ".");
    terminal.say("");
    rows.clear();
    for (std::size_t k = 0; k < adapted.after.channels.size(); ++k) {
        const auto &before = adapted.before.channels[k].total, &after = adapted.after.channels[k].total;
        rows.push_back({titleOf(adapted.after.channels[k]), fixed(before.db, 1), fixed(after.db, 1),
                        decibelText(after.noiseFloorDb),
                        chiSquaredText(before.chiSquaredPerValue, adapted.before.noiseKnown),
                        chiSquaredText(after.chiSquaredPerValue, adapted.after.noiseKnown)});
    }
    terminal.table(
        {"channel", "error dB before", "after", "noise dB", std::string(chiSquaredTitle) + " before", "after"}, rows);
    if (const auto sentence = sentenceOn(adapted); !sentence.empty())
        terminal.say(wrapped(sentence));
}

void run(const AdaptArguments& options, Terminal& terminal)
{
    requireFilePlace(options.out);
    const auto model = readModel(options.model);
    nlohmann::ordered_json document = DocumentFormat {"excursion-adapt"}.with();
    const auto open = openTake(options.take);
    requireSameKind(model, seenIn(open.take.either()));
    if (!open.take.report().fitForUse())
        return refuseTake(open, document, terminal);
    const auto names = options.parameters.empty() ? driftingParameters(model) : options.parameters;
    const auto adapted = adaptTo(model, open.take, names, terminal.progress());
    const auto& drift = adapted.drift;
    writeModel(drift.model, options.out);

    sayProblems(open.take.report().problems, terminal);
    print(adapted, terminal);
    terminal.say("Wrote " + options.out + ".");
    document["take"] = options.take;
    document["before"] = options.model;
    document["model"] = options.out;
    document["drift"] = documentOf(drift.parameters);
    document["figures"] = documentOf(drift.figures);
    document["warmer"] = drift.warmer ? nlohmann::ordered_json(*drift.warmer) : nlohmann::ordered_json(nullptr);
    document["errorBefore"] = toJson(errorByChannel(adapted.before));
    document.update(modelJson(drift.model, adapted.after, drift.search));
    document["sentence"] = sentenceOn(adapted);
    terminal.document(document);
}

}  // namespace

void addAdapt(CLI::App& app, Terminal& terminal)
{
    const auto [verb, o] = addVerb<AdaptArguments>(app, terminal, step::use, "adapt",
                                                   "Refit what drifts with temperature and age, to a short take", run);
    verb->add_option("MODEL", o->model, "the model of the driver, a .json")->required();
    verb->add_option("TAKE", o->take, "a new take or impedance of the same driver; a short one will do")->required();
    verb->add_option(
            "--parameters", o->parameters,
            "base parameters that may have changed, separated by commas; each takes its law along (default: Re,Rms,K)")
        ->delimiter(',')
        ->type_name("NAME");
    verb->add_option("--out", o->out, "the model as it is now, a .json")->required()->type_name("FILE");
    verb->footer("Exit code 1: the take is not fit for use, and no model was written.");
}

}  // namespace excursion::cli
