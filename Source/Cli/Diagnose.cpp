// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/ModelTables.h"
#include "Cli/OpenTake.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"

#include "Engine/Diagnosis/Diagnose.h"
#include "Engine/Diagnosis/DiagnosisFile.h"
#include "Engine/Loudspeaker/ModelFile.h"
#include "Engine/Loudspeaker/Seen.h"

#include <nlohmann/json.hpp>

#include <memory>

namespace excursion::cli {
namespace {

using Rows = std::vector<std::vector<std::string>>;

struct DiagnoseArguments {
    std::string take, model;
};

Diagnosis diagnosisOf(const Model& model, const OpenTake& open, Terminal& terminal)
{
    if (!open.take.report().fitForUse()) {
        Diagnosis diagnosis;
        diagnosis.verdict = Verdict::badMeasurement;
        diagnosis.sentence = open.take.report().verdict();
        return diagnosis;
    }
    const auto progress = terminal.progress();
    if (const auto* spectra = open.take.asResponses())
        return diagnose(model, *spectra, compare(model, *spectra), {}, progress);
    const auto record = recordFor(model, open);
    const auto before = compare(model, record, {}, progress.part(0.0, 0.1));
    return diagnose(model, record, before, {}, progress.part(0.1, 1.0));
}

/// The error of the model as it is in the first row, then that with each candidate: as a refit confirmed it, else as
/// predicted.
void printRanking(const Diagnosis& diagnosis, Terminal& terminal)
{
    std::vector<std::string> header {"effect", "confidence"};
    std::vector<std::string> now {"the model as it is", "-"};
    for (const auto& [quantity, error] : diagnosis.error) {
        header.push_back(std::string(name(quantity)) + " dB");
        now.push_back(fixed(error.db, 1));
    }
    header.push_back("by");
    now.emplace_back("");
    Rows rows {now};
    for (const auto& ranked : diagnosis.ranking) {
        const bool tried = !ranked.confirmedErrorDb.empty();
        const auto& errors = tried ? ranked.confirmedErrorDb : ranked.predictedErrorDb;
        std::vector<std::string> row {"with " + ranked.effect, confidenceText(ranked.confidence)};
        for (const auto& entry : diagnosis.error) {
            const auto found = errors.find(entry.first);
            row.push_back(found != errors.end() ? fixed(found->second, 1) : "-");
        }
        row.emplace_back(tried ? "a refit" : "prediction");
        rows.push_back(std::move(row));
    }
    std::vector<std::string> floor {"the noise", "-"};
    bool known = false;
    for (const auto& entry : diagnosis.error) {
        floor.push_back(decibelText(entry.second.noiseFloorDb));
        known = known || entry.second.noiseFloorDb;
    }
    if (known)
        rows.push_back(std::move(floor));
    terminal.table(header, rows);
    terminal.say(wrapped("In order: the effects that the whole catalogue speaks for, then the others, each by what is "
                         "left. Confidence: of one effect added alone."));
}

void print(const Diagnosis& diagnosis, Terminal& terminal)
{
    sayProblems(diagnosis.problems, terminal);
    if (!diagnosis.error.empty())
        printRanking(diagnosis, terminal);
    terminal.say("");
    terminal.say(wrapped("verdict  " + std::string(name(diagnosis.verdict)) + ": " + diagnosis.sentence, 9));
    if (diagnosis.verdict == Verdict::missingEffect)
        terminal.say(wrapped("reason   " + diagnosis.ranking.front().reason, 9));
    if (!diagnosis.measureNext.empty())
        terminal.say(wrapped("next     " + diagnosis.measureNext, 9));
}

void run(const DiagnoseArguments& options, Terminal& terminal)
{
    const auto model = readModel(options.model);
    const auto open = openTake(options.take);
    requireSameKind(model, seenIn(open.take.either()));
    auto diagnosis = diagnosisOf(model, open, terminal);
    tell(diagnosis, open.take.report().problems);
    print(diagnosis, terminal);
    terminal.document(toJson(diagnosis));
    if (diagnosis.verdict == Verdict::badMeasurement)
        terminal.answer = 1;
}

}  // namespace

void addDiagnose(CLI::App& app, Terminal& terminal)
{
    const auto [verb, o] = addVerb<DiagnoseArguments>(app, terminal, step::diagnose, "diagnose",
                                                      "Name the physical effect that a model is missing", run);
    verb->add_option("TAKE", o->take, "the take or impedance that the model was fitted to")->required();
    verb->add_option("--model", o->model, "the model, a .json")->required()->type_name("FILE");
    verb->footer(
        "Verdicts: missing-effect, complete, unknown-effect (something is left that no effect of the catalogue\n"
        "explains), bad-measurement. Exit code 1: bad-measurement.");
}

}  // namespace excursion::cli
