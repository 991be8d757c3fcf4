// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/ComparisonFile.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Document/Words.h"
#include "Plots/Words.h"
#include "Report/Chapters.h"

namespace excursion {
namespace {

std::string_view tone(Verdict verdict)
{
    switch (verdict) {
    case Verdict::complete: return "good";
    case Verdict::badMeasurement: return "bad";
    default: return "warn";
    }
}

}  // namespace

void addVerdict(Page& page, const LadderFile& file)
{
    const auto& ladder = file.ladder;
    const auto& take = file.take;
    page.headline(ladder.sentence.empty() ? "Verdict: " + std::string(name(ladder.verdict)) + "." : ladder.sentence,
                  tone(ladder.verdict));
    if (ladder.rungs.size() > 1) {
        std::vector<std::string> falls;
        const auto first = errorByChannel(ladder.rungs.front().comparison),
                   last = errorByChannel(ladder.rungs.back().comparison);
        for (const auto& [quantity, error] : last)
            if (const auto before = first.find(quantity); before != first.end())
                falls.push_back(std::string(name(quantity)) + " from " + decibels(before->second.db) + " to "
                                + decibels(error.db));
        std::vector<std::string> added;
        for (const auto& rung : ladder.rungs)
            if (!rung.added.empty())
                added.push_back(effectTitle(rung.added));
        page.paragraph("Added: " + joined(added) + ". The error fell: " + joined(falls) + ".");
    }
    std::vector<std::pair<std::string, std::string>> facts {{"Take", take.path}};
    if (!take.channels.empty())
        facts.emplace_back("Channels", joined(take.channels));
    if (take.sampleRate > 0.0) {
        facts.emplace_back("Length", engineering(take.seconds, "s", 3));
        facts.emplace_back("Sample rate", nominal(take.sampleRate, "Hz"));
    }
    if (!take.levels.empty()) {
        std::vector<std::string> levels;
        for (const double level : take.levels)
            levels.push_back(nominal(level, "V"));
        facts.emplace_back("Levels, rms", joined(levels));
    }
    if (take.realizations > 0)
        facts.emplace_back("Realizations \u00d7 periods",
                           std::to_string(take.realizations) + " \u00d7 " + std::to_string(take.periods));
    page.facts(facts);
}

void addProblems(Page& page, const LadderFile& file)
{
    if (file.ladder.problems.empty())
        return;
    page.section("Problems of the take");
    std::vector<std::vector<Page::Cell>> rows;
    for (const auto& p : file.ladder.problems)
        rows.push_back({p.fatal ? "fatal" : "noted", p.kind,
                        p.channel ? std::string(name(*p.channel)) : std::string("all"),
                        Page::figure(engineering(p.value, p.unit, 3)), p.sentence});
    page.table({"", "Kind", "Channel", "Amount", "In words"}, rows);
    page.note("A fatal problem stops the diagnosis, as a model would explain the fault instead of the loudspeaker.");
}

}  // namespace excursion
