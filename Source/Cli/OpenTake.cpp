// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/OpenTake.h"

#include "Cli/Terminal.h"
#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/DiagnosisFile.h"
#include "Engine/Diagnosis/FollowSections.h"
#include "Engine/Error.h"
#include "Engine/Import/ReadTake.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/Seen.h"

namespace excursion::cli {

OpenTake openTake(const std::string& path) { return {path, readTake(path)}; }

void requireEffects(const std::vector<std::string>& ids, const PreparedTake& take)
{
    const auto seen = seenIn(take.either());
    for (const auto& id : ids)
        if (const auto why = whyUnseen(effectNamed(id), seen); !why.empty())
            throw Error(Error::Kind::usage, why);
}

Record recordFor(const Model& model, const OpenTake& open)
{
    auto record = open.take.record();
    adapt(record, model);
    if (followsDrift(model, record))
        takeDriftOutOfNoise(record);
    record.sectionsDrift = movesExplain(model, record);
    return record;
}

void sayProblems(const std::vector<Problem>& problems, Terminal& terminal)
{
    for (const auto& p : problems)
        terminal.say(wrapped((p.fatal ? "fault   " : "remark  ") + p.kind + ": " + p.sentence, 8));
}

void refuseTake(const OpenTake& open, nlohmann::ordered_json document, Terminal& terminal)
{
    sayProblems(open.take.report().problems, terminal);
    terminal.say("");
    terminal.say("The take is not fit for use: a model of it would explain the fault, not the loudspeaker. Nothing was "
                 "written.");
    document["take"] = open.path;
    document["verdict"] = name(Verdict::badMeasurement);
    document["sentence"] = open.take.report().verdict();
    document["problems"] = toJson(open.take.report().problems);
    terminal.document(document);
    terminal.answer = 1;
}

}  // namespace excursion::cli
