// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"
#include "Cli/LiveLadder.h"
#include "Cli/OpenTake.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"
#include "Engine/Import/ReadTake.h"

#include "Engine/Diagnosis/Improve.h"
#include "Engine/Diagnosis/LadderFile.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/ModelFile.h"
#include "Report/Report.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>

namespace excursion::cli {
namespace {

struct ImproveArguments {
    std::string take, out;
    std::vector<std::string> with, former;
};

/// The page is the last and the least: without it the ladder is still whole. It is drawn from the ladder as it was
/// written, so that `excursion report` draws the same.
void writeFolder(const LadderFile& file, const std::filesystem::path& folder)
{
    writeLadder(file, folder / "ladder.json");
    if (file.ladder.rungs.empty())
        std::filesystem::remove(folder / "model.json");  // one of an earlier run does not belong to this ladder
    else
        writeModel(file.ladder.model(), folder / "model.json");
    try {
        writeReport(readLadder(folder / "ladder.json"), folder / "report.html");
    } catch (const Error& e) {
        throw Error(e.kind(), std::string(e.what()) + " The ladder and the model are kept in '" + folder.string()
                                  + "': excursion report draws the page later.");
    }
}

void run(const ImproveArguments& options, Terminal& terminal)
{
    for (const auto& id : options.with)
        effectNamed(id);  // a misspelt name is told before any work
    requireFolderPlace(options.out);
    const PreparedTake take(readTake(options.take));
    requireEffects(options.with, take);
    LiveLadder live(terminal);
    ImproveOptions improvement;
    improvement.with = options.with;
    improvement.finished = [&live](const Rung& rung) { live.show(rung); };
    auto ladder = improve(take, improvement, terminal.progress());
    const auto file = makeLadderFile(std::move(ladder), take, options.take);
    writeFolder(file, options.out);

    live.end(file.ladder);
    terminal.say(
        "Wrote " + options.out
        + (file.ladder.rungs.empty() ? "/ladder.json and report.html." : "/ladder.json, model.json and report.html."));
    terminal.document(toJson(file));
    if (file.ladder.verdict == Verdict::badMeasurement)
        terminal.answer = 1;
}

}  // namespace

void addImprove(CLI::App& app, Terminal& terminal)
{
    auto o = std::make_shared<ImproveArguments>();
    auto* verb = app.add_subcommand("improve", "Diagnose, add and refit until nothing is missing; keep the ladder")
                     ->group(step::diagnose);
    verb->add_option("TAKE", o->take,
                     "the take: a folder, a .csv, or an impedance or other response (.zma, .frd, .txt)")
        ->required();
    verb->add_option("--effects", o->with, "effects that the first model has already, separated by commas")
        ->delimiter(',')
        ->type_name("EFFECT");
    verb->add_option("--with", o->former, "the same, as it was called before")->delimiter(',')->group("");
    verb->add_option("--out", o->out, "folder for ladder.json, model.json and report.html")
        ->required()
        ->type_name("DIR");
    verb->footer("Exit code 1: the take is not fit for use.");
    verb->callback([o, &terminal] {
        o->with.insert(o->with.end(), o->former.begin(), o->former.end());
        run(*o, terminal);
    });
}

}  // namespace excursion::cli
