// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"

#include "Engine/Diagnosis/LadderFile.h"
#include "Report/Report.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>

namespace excursion::cli {
namespace {

void run(const std::string& folder, Terminal& terminal)
{
    const auto ladder = (std::filesystem::path(folder) / "ladder.json").string();
    const auto page = (std::filesystem::path(folder) / "report.html").string();
    const auto file = readLadder(ladder);
    requireFilePlace(page);
    writeReport(file, page);
    terminal.say("Wrote " + page + ".");
    terminal.document({{"format", "excursion-report"},
                       {"version", 1},
                       {"ladder", ladder},
                       {"report", page},
                       {"verdict", name(file.ladder.verdict)},
                       {"sentence", file.ladder.sentence}});
}

} // namespace

void addReport(CLI::App& app, Terminal& terminal)
{
    auto folder = std::make_shared<std::string>();
    auto* verb = app.add_subcommand("report", "Draw the report of a ladder again, as one page that needs nothing else")->group(step::diagnose);
    verb->add_option("DIR", *folder, "folder of an earlier improve: ladder.json is read, report.html written")->required();
    verb->callback([folder, &terminal] { run(*folder, terminal); });
}

} // namespace excursion::cli
