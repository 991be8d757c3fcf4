// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/OpenTake.h"

#include "Cli/Terminal.h"
#include "Engine/Diagnosis/DiagnosisFile.h"
#include "Engine/Driver/Catalogue.h"
#include "Engine/Driver/Fit.h"
#include "Engine/Driver/Seen.h"
#include "Engine/Error.h"
#include "Engine/Measurement/FindExcitation.h"
#include "Engine/Measurement/TakeFile.h"

namespace excursion::cli {
namespace {

bool hasCoil(const Take& take)
{
    const auto* spectra = std::get_if<Spectra>(&take);
    return spectra ? spectra->find(Quantity::voltage) != nullptr
                   : std::get<Measurement>(take).input().quantity == Quantity::voltage;
}

}  // namespace

OpenTake openTake(const std::string& path)
{
    OpenTake open {path, readTake(path), {}};
    if (auto* measurement = std::get_if<Measurement>(&open.take))
        completeExcitation(*measurement);
    open.report = std::visit([](const auto& take) { return check(take); }, open.take);
    return open;
}

void requireEffects(const std::vector<std::string>& ids, const Take& take)
{
    const auto seen = std::visit([](const auto& t) { return seenIn(t); }, take);
    for (const auto& id : ids)
        if (const auto why = whyUnseen(effectNamed(id), seen); !why.empty())
            throw Error(Error::Kind::usage, why);
}

void requireSameKind(const Model& model, const OpenTake& open)
{
    if (model.electrical() == hasCoil(open.take))
        return;
    throw Error(Error::Kind::data,
                model.electrical()
                    ? "The model has a coil, but the take drives the cone by a force; fit a model to this take."
                    : "The model has no coil, but the take drives one by a voltage; fit a model to this take.");
}

Record recordFor(const Model& model, const OpenTake& open)
{
    auto record = makeRecord(open.measurement());
    adapt(record, model);
    return record;
}

void sayProblems(const std::vector<Problem>& problems, Terminal& terminal)
{
    for (const auto& p : problems)
        terminal.say(wrapped((p.fatal ? "fault   " : "remark  ") + p.kind + ": " + p.sentence, 8));
}

void refuseTake(const OpenTake& open, nlohmann::ordered_json document, Terminal& terminal)
{
    sayProblems(open.report.problems, terminal);
    terminal.say("");
    terminal.say("The take is not fit for use: a model of it would explain the fault, not the loudspeaker. Nothing was "
                 "written.");
    document["take"] = open.path;
    document["verdict"] = name(Verdict::badMeasurement);
    document["sentence"] = open.report.verdict();
    document["problems"] = toJson(open.report.problems);
    terminal.document(document);
    terminal.answer = 1;
}

}  // namespace excursion::cli
