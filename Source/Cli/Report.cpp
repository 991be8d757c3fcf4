// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"

#include "Engine/Diagnosis/LadderFile.h"
#include "Engine/Document/DocumentFormat.h"
#include "Engine/Error.h"
#include "Report/ModelReport.h"
#include "Report/Report.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>

namespace excursion::cli {
namespace {

void drawLadder(const std::string& folder, Terminal& terminal)
{
    const auto ladder = (std::filesystem::path(folder) / "ladder.json").string();
    const auto page = (std::filesystem::path(folder) / "report.html").string();
    const auto file = readLadder(ladder);
    requireFilePlace(page);
    writeReport(file, page);
    terminal.say("Wrote " + page + ".");
    terminal.document(DocumentFormat {"excursion-report"}.with({{"ladder", ladder},
                                                                {"report", page},
                                                                {"verdict", name(file.ladder.verdict)},
                                                                {"sentence", file.ladder.sentence}}));
}

void drawDocument(const std::string& path, Terminal& terminal)
{
    if (std::filesystem::path(path).extension() != ".json")
        throw Error(Error::Kind::usage, "'" + path
                                            + "' is no document of this program: a page is drawn of the folder of "
                                              "excursion improve, or of a .json; "
                                              "if it is a take, excursion improve '"
                                            + path + "' --out DIR draws its page.");
    const auto document = readJson(path);
    const auto page = std::filesystem::path(path).replace_extension(".html").string();
    requireFilePlace(page);
    writeDocumentPage(JsonField(document, "", path), page);
    terminal.say("Wrote " + page + ".");
    terminal.document(DocumentFormat {"excursion-report"}.with({{"document", path}, {"report", page}}));
}

void run(const std::string& place, Terminal& terminal)
{
    std::error_code ignored;
    const bool document = std::filesystem::is_regular_file(place, ignored)
                          || std::filesystem::path(place).extension() == ".json";
    (document ? drawDocument : drawLadder)(place, terminal);
}

}  // namespace

void addReport(CLI::App& app, Terminal& terminal)
{
    auto place = std::make_shared<std::string>();
    auto* verb =
        app.add_subcommand(
               "report",
               "Draw a ladder again, or a document of identify, pnlss, rank or harmonics, as one self-contained page")
            ->group(step::diagnose);
    verb->add_option("PLACE", *place,
                     "folder of an earlier improve: ladder.json is read, report.html written; or a .json: a model from "
                     "identify (also --cone), reduce or stabilize, or what --json FILE of identify, pnlss, rank or "
                     "harmonics wrote; the page is put beside it")
        ->required();
    verb->callback([place, &terminal] { run(*place, terminal); });
}

}  // namespace excursion::cli
