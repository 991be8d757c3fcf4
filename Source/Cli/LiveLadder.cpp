// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/LiveLadder.h"

#include "Cli/ModelTables.h"
#include "Cli/OpenTake.h"
#include "Cli/Terminal.h"
#include "Engine/Document/Words.h"
#include "Engine/Loudspeaker/Catalogue.h"

#include <algorithm>
#include <utility>

namespace excursion::cli {
namespace {

/// As wide as the longest effect needs, so that no later row breaks the columns of an earlier one.
std::size_t labelWidth()
{
    std::size_t width = 0;
    for (const auto* effect : catalogue())
        width = std::max(width, effect->id().size());
    return width + 5;  // "1  + "
}

}  // namespace

void LiveLadder::begin(const Comparison& comparison)
{
    std::vector<std::string> floor, rule;
    for (const auto& channel : comparison.channels) {
        titles_.push_back(titleOf(channel) + " dB");
        floor.push_back(decibelText(channel.total.noiseFloorDb));
    }
    titles_.emplace_back(chiSquaredTitle);
    floor.push_back(comparison.noiseKnown ? "1" : "-");
    for (const auto& title : titles_)
        rule.emplace_back(std::max<std::size_t>(columnsOf(title), 8), '-');
    row("error of the model", titles_);
    row(std::string(labelWidth(), '-'), rule);
    if (comparison.noiseKnown)
        row("   noise floor", floor);
}

void LiveLadder::row(const std::string& label, const std::vector<std::string>& cells)
{
    std::string text = "  " + label + std::string(labelWidth() - std::min(labelWidth(), label.size()), ' ');
    for (std::size_t c = 0; c < cells.size(); ++c) {
        const auto width = std::max<std::size_t>(columnsOf(titles_[c]), 8);
        text += "  " + std::string(width - std::min(width, columnsOf(cells[c])), ' ') + cells[c];
    }
    terminal_.say(text);
}

void LiveLadder::show(const Rung& rung)
{
    const auto& comparison = rung.comparison;
    if (rung.added.empty() && rungs_ > 0) {
        terminal_.say(std::exchange(again_, true)
                          ? "\nThat fits worse. The earlier ladder is kept:"
                          : "\nThe recorder's coupling was found. The ladder begins again without it:");
        rungs_ = 0;
        titles_.clear();
    }
    if (rungs_ == 0)
        begin(comparison);
    std::vector<std::string> cells;
    for (const auto& channel : comparison.channels)
        cells.push_back(fixed(channel.total.db, 1));
    cells.push_back(chiSquaredText(comparison.chiSquaredPerValue, comparison.noiseKnown));
    const auto first = rung.model.effectIds().empty() ? "linear model" : "first model";
    row(std::to_string(rungs_) + "  " + (rung.added.empty() ? first : "+ " + rung.added), cells);
    ++rungs_;

    const auto& diagnosis = rung.diagnosis;
    if (diagnosis.verdict != Verdict::missingEffect)
        return;
    const auto& best = diagnosis.ranking.front();
    terminal_.say(wrapped(
        "     missing: " + best.effect + " (" + confidenceText(best.confidence) + " sure). " + best.reason, 14));
    if (!diagnosis.indistinguishable.empty()) {
        const auto others = joined(diagnosis.indistinguishable, " or ");
        terminal_.say(wrapped("     or else: " + others + "; this take cannot tell. " + diagnosis.measureNext, 14));
    }
}

void LiveLadder::end(const Ladder& ladder)
{
    if (rungs_ > 0)
        terminal_.say("");
    for (const auto& id : ladder.withdrawn)
        terminal_.say("withdrawn  " + id + ": it explained little more than what is left unexplained in the end.");
    sayProblems(ladder.problems, terminal_);
    if (!ladder.problems.empty())
        terminal_.say("");
    terminal_.say(wrapped("verdict  " + std::string(name(ladder.verdict)) + ": " + ladder.sentence, 9));
}

}  // namespace excursion::cli
