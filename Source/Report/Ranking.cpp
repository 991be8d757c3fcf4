// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/Engineering.h"
#include "Engine/Document/Words.h"
#include "Plots/Words.h"
#include "Report/Chapters.h"

#include <algorithm>

namespace excursion {
namespace {

std::string errorsText(const std::map<Quantity, double>& errors)
{
    std::string text;
    for (const auto& [quantity, db] : errors)
        text += (text.empty() ? "" : ", ") + std::string(name(quantity)) + " " + decibels(db);
    return text.empty() ? "not tried" : text;
}

}  // namespace

void addRanking(Page& page, const LadderFile& file)
{
    const auto& ladder = file.ladder;
    page.section("What competed at each rung");
    for (std::size_t k = 0; k < ladder.rungs.size(); ++k) {
        const auto& diagnosis = ladder.rungs[k].diagnosis;
        if (diagnosis.ranking.empty() && diagnosis.sentence.empty())
            continue;
        page.subsection("After rung " + rungTitle(ladder, k));
        page.paragraph(diagnosis.sentence);
        if (!diagnosis.indistinguishable.empty()) {
            const auto names = joined(diagnosis.indistinguishable, [&](const auto& id) { return effectTitle(id); });
            page.paragraph("This take cannot tell the first of the ranking from: " + names + ". "
                           + diagnosis.measureNext);
        }
        std::vector<std::vector<Page::Cell>> rows;
        std::string untried;
        for (const auto& ranked : diagnosis.ranking) {
            if (ranked.confirmedErrorDb.empty()) {  // what promises nothing has no reason to be read
                untried += (untried.empty() ? "" : ", ") + effectTitle(ranked.effect);
                continue;
            }
            rows.push_back({effectTitle(ranked.effect),
                            Page::Cell::bar(ranked.confidence,
                                            fixedText(std::min(99.0, 100.0 * ranked.confidence), 0) + "\u202f%"),
                            errorsText(ranked.predictedErrorDb), errorsText(ranked.confirmedErrorDb), ranked.reason});
        }
        if (!rows.empty())
            page.table({"Effect", "Confidence", "Predicted error", "Confirmed error", "Reason"}, rows);
        if (!untried.empty())
            page.paragraph("Not tried, as they promised less: " + untried + ".");
    }
    page.note("The predicted error comes from a score test, the confirmed one from a refit judged on data that it did "
              "not see.");
}

}  // namespace excursion
