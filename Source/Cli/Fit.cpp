// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"
#include "Cli/ModelTables.h"
#include "Cli/OpenTake.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"

#include "Engine/Diagnosis/FitEffects.h"
#include "Engine/Diagnosis/FollowSections.h"
#include "Engine/Diagnosis/Refine.h"
#include "Engine/Document/DocumentFormat.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FitResponse.h"
#include "Engine/Loudspeaker/ModelFile.h"

#include <nlohmann/json.hpp>

#include <memory>

namespace excursion::cli {
namespace {

struct FitArguments {
    std::string take, out;
    std::vector<std::string> effects;
};

void run(const FitArguments& options, Terminal& terminal)
{
    for (const auto& id : options.effects)
        effectNamed(id);  // a misspelt name is told before any work
    requireFilePlace(options.out);
    nlohmann::ordered_json document = DocumentFormat {"excursion-fit"}.with();
    const auto open = openTake(options.take);
    requireEffects(options.effects, open.take);
    if (!open.take.report().fitForUse())
        return refuseTake(open, document, terminal);

    Model model;
    FitSummary summary;
    Comparison comparison;
    std::string caveats;
    if (open.take.asResponses()) {
        model = fitEffects(*open.take.asResponses(), options.effects, &summary);
        comparison = compare(model, *open.take.asResponses());
        caveats = caveatsOf(model, responsesOf(*open.take.asResponses()));
    } else {
        auto record = open.take.record();
        const auto progress = terminal.progress();
        model = fitEffects(record, options.effects, {}, &summary, progress.part(0.0, 0.9));
        if (auto following = followingSections(model, record, summary.substeps)) {
            model = std::move(following->model);
            summary = following->fit;
            record.sectionsDrift = true;
            auto again = model;
            if (const auto run = refine(again, record, {}, progress.part(0.9, 0.95)); run.usable()) {
                model = std::move(again);
                summary = run;
            }
        }
        comparison = compare(model, record, {summary.substeps, false}, progress.part(0.95, 1.0));
        caveats = caveatsOf(model);
    }
    writeModel(model, options.out);

    sayProblems(open.take.report().problems, terminal);
    terminal.say(wrapped("The model: " + effectsText(model) + "." + caveats));
    terminal.say("");
    printParameters(model, terminal);
    terminal.say("");
    printErrors(comparison, terminal);
    if (comparison.sectionMoves)
        terminal.say(wrapped(told(*comparison.sectionMoves)));
    terminal.say("Wrote " + options.out + ".");
    document["take"] = options.take;
    document["model"] = options.out;
    document.update(modelJson(model, comparison, summary));
    terminal.document(document);
}

}  // namespace

void addFit(CLI::App& app, Terminal& terminal)
{
    const auto [verb, o] = addVerb<FitArguments>(
        app, terminal, step::fit, "fit", "Fit a model to a take: the linear base and the effects you name", run);
    verb->add_option("TAKE", o->take,
                     "the take: a folder, a .csv, or an impedance or other response (.zma, .frd, .txt)")
        ->required();
    verb->add_option("--effects", o->effects, "effects to include, separated by commas; excursion effects lists them")
        ->delimiter(',')
        ->type_name("EFFECT");
    verb->add_option("--out", o->out, "the model, a .json")->required()->type_name("FILE");
    verb->footer("Exit code 1: the take is not fit for use, and no model was written.");
}

}  // namespace excursion::cli
