// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/ComparisonFile.h"
#include "Engine/Document/Engineering.h"
#include "Plots/Plots.h"
#include "Plots/Words.h"
#include "Report/Chapters.h"

#include <limits>

namespace excursion {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

}  // namespace

void addRungs(Page& page, const LadderFile& file)
{
    const auto& ladder = file.ladder;
    page.section("The ladder");
    std::vector<std::string> header {"Rung"};
    const auto& channels = ladder.rungs.front().comparison.channels;
    for (const auto& channel : channels) {
        header.push_back(capitalized(name(channel.quantity)));
        header.emplace_back("predicted");
    }
    header.emplace_back("\u03c7\u00b2 per value");
    std::vector<std::vector<Page::Cell>> rows;
    for (std::size_t k = 0; k < ladder.rungs.size(); ++k) {
        const auto& rung = ladder.rungs[k];
        const auto errors = errorByChannel(rung.comparison);
        std::vector<Page::Cell> row {rungTitle(ladder, k)};
        for (const auto& channel : channels) {
            const auto error = errors.find(channel.quantity);
            const auto guess = rung.predictedErrorDb.find(channel.quantity);
            row.push_back(Page::figure(error == errors.end() ? "\u2013" : decibels(error->second.db)));
            row.push_back(Page::figure(
                rung.added.empty() || guess == rung.predictedErrorDb.end() ? "\u2013" : decibels(guess->second)));
        }
        row.push_back(Page::figure(rung.comparison.noiseKnown ? engineering(rung.comparison.chiSquaredPerValue, "1", 3)
                                                              : "\u2013"));
        rows.push_back(std::move(row));
    }
    std::vector<Page::Cell> floors {"noise floor"};
    for (const auto& channel : ladder.rungs.back().comparison.channels) {
        floors.push_back(Page::figure(decibels(channel.total.noiseFloorDb.value_or(nothing))));
        floors.emplace_back("");
    }
    floors.push_back(Page::figure("1"));
    rows.push_back(std::move(floors));
    page.table(header, rows);
    page.note(std::string("Errors are relative rms over all levels, on ")
              + (ladder.rungs.back().comparison.validated ? "data that no fit saw. "
                                                          : "the data that was fitted, as nothing could be held out. ")
              + "A \u03c7\u00b2 per value of 1 means that nothing but noise is left.");
    for (const auto& id : ladder.withdrawn)
        page.paragraph("Tried and withdrawn: " + effectTitle(id) + "; what it left was as large as what it explained.");
    std::vector<Plot> plots;
    for (const auto& channel : channels)
        plots.push_back(fallPlot(ladder, channel.quantity));
    page.figures(std::move(plots),
                 "Each rung adds one effect and refits everything: the model is complete where the error meets the "
                 "noise floor.");
}

}  // namespace excursion
