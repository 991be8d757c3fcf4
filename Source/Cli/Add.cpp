// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"
#include "Cli/ModelTables.h"
#include "Cli/OpenTake.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"

#include "Engine/Diagnosis/ComparisonFile.h"
#include "Engine/Diagnosis/FitEffects.h"
#include "Engine/Diagnosis/Refine.h"
#include "Engine/Diagnosis/Trial.h"
#include "Engine/Document/DocumentFormat.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/ModelFile.h"
#include "Engine/Loudspeaker/Seen.h"

#include <nlohmann/json.hpp>

#include <memory>

namespace excursion::cli {
namespace {

struct AddArguments {
    std::string take, model, effect, out;
};

struct Added {
    Model model;
    FitSummary fit;
    Comparison before, after;
};

Added addTo(const Model& model, const Effect& effect, const Spectra& spectra)
{
    Added result;
    result.before = compare(model, spectra);
    auto effects = model.effectIds();
    effects.push_back(effect.id());
    result.model = fitEffects(spectra, effects, &result.fit);
    result.after = compare(result.model, spectra);
    return result;
}

/// The effect is put in where the score test says that it starts, fitted quickly, then everything is refitted. While
/// more is missing that is with laws that are fed; played by itself such a model may leave more than the quick fit.
Added addTo(const Model& model, const Effect& effect, Record record, const Progress& progress)
{
    Added result;
    result.before = compare(model, record, {0, false}, progress.part(0.0, 0.05));
    result.model = model;
    const auto quickly = tryEffect(result.model, record, effect, {}, progress.part(0.05, 0.5));
    const auto quick = result.model;
    const bool other = noiseHoldsDrift(record);
    result.fit = refineByNoise(result.model, record, {}, progress.part(0.5, 0.95));
    if (other && !noiseHoldsDrift(record))
        result.before = compare(model, record, {0, false});
    const auto tried = quickly.usable() ? tryCompare(quick, record, {0, false}) : std::nullopt,
               refined = result.fit.usable() ? tryCompare(result.model, record, {0, false}) : std::nullopt;
    if (!tried && !refined)
        throw Error(Error::Kind::numerical, "The fit failed: " + result.fit.message + ".");
    if (tried && (!refined || tried->chiSquaredPerValue < refined->chiSquaredPerValue)) {
        result.model = quick;
        result.fit = quickly;
        result.after = *tried;
    } else {
        result.after = *refined;
    }
    progress.at(1.0, "compared");
    return result;
}

/// By chi squared; where the take does not tell its noise, by the errors themselves.
bool fell(const Added& added)
{
    if (added.before.noiseKnown && added.after.noiseKnown)
        return added.after.chiSquaredPerValue < added.before.chiSquaredPerValue;
    for (std::size_t k = 0; k < added.after.channels.size(); ++k)
        if (added.after.channels[k].total.db < added.before.channels[k].total.db - 0.05)
            return true;
    return false;
}

void print(const Added& added, const Effect& effect, Terminal& terminal)
{
    terminal.say("Added " + effect.title() + ". " + effect.physics());
    terminal.say("");
    std::vector<std::vector<std::string>> rows;
    for (std::size_t k = 0; k < added.after.channels.size(); ++k) {
        const auto &before = added.before.channels[k].total, &after = added.after.channels[k].total;
        rows.push_back({titleOf(added.after.channels[k]), fixed(before.db, 1), fixed(after.db, 1),
                        decibelText(after.noiseFloorDb),
                        chiSquaredText(before.chiSquaredPerValue, added.before.noiseKnown),
                        chiSquaredText(after.chiSquaredPerValue, added.after.noiseKnown)});
    }
    terminal.table(
        {"channel", "error dB before", "after", "noise dB", std::string(chiSquaredTitle) + " before", "after"}, rows);
    terminal.say("");
    printParameters(added.model, terminal);
    if (!fell(added)) {
        terminal.say("");
        terminal.say("The error did not fall: the take does not ask for this effect.");
    }
}

void run(const AddArguments& options, Terminal& terminal)
{
    const auto& effect = effectNamed(options.effect);
    requireFilePlace(options.out);
    const auto model = readModel(options.model);
    nlohmann::ordered_json document = DocumentFormat {"excursion-add"}.with({{"added", effect.id()}});
    const auto open = openTake(options.take);
    requireSameKind(model, seenIn(open.take.either()));
    requireEffects({effect.id()}, open.take);
    if (model.has(effect.id()))
        throw Error(Error::Kind::usage, "The model already has the effect \"" + effect.id() + "\".");
    if (!open.take.report().fitForUse())
        return refuseTake(open, document, terminal);
    const auto added = open.take.asResponses() ? addTo(model, effect, *open.take.asResponses())
                                               : addTo(model, effect, recordFor(model, open), terminal.progress());
    writeModel(added.model, options.out);

    sayProblems(open.take.report().problems, terminal);
    print(added, effect, terminal);
    terminal.say("");
    terminal.say("Wrote " + options.out + ".");
    document["take"] = options.take;
    document["model"] = options.out;
    document["errorBefore"] = toJson(errorByChannel(added.before));
    document.update(modelJson(added.model, added.after, added.fit));
    terminal.document(document);
}

}  // namespace

void addAdd(CLI::App& app, Terminal& terminal)
{
    const auto [verb, o] = addVerb<AddArguments>(app, terminal, step::diagnose, "add",
                                                 "Put an effect into a model and refit everything", run);
    verb->add_option("TAKE", o->take, "the take or impedance that the model was fitted to")->required();
    verb->add_option("EFFECT", o->effect, "the effect, such as stiffness; excursion effects lists them")->required();
    verb->add_option("--model", o->model, "the model, a .json")->required()->type_name("FILE");
    verb->add_option("--out", o->out, "the new model, a .json")->required()->type_name("FILE");
    verb->footer("Exit code 1: the take is not fit for use, and no model was written.");
}

}  // namespace excursion::cli
