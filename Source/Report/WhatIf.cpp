// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Datasheet/KnownScale.h"
#include "Engine/Design/WhatIf.h"

#include "Engine/Document/Engineering.h"
#include "Plots/Plots.h"
#include "Plots/Words.h"
#include "Report/Chapters.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

Page::Cell side(const std::optional<double>& metres, double atEnd)
{
    return Page::figure(metres ? engineering(*metres, "m", 3) : "not reached (" + engineering(atEnd, "%", 3) + ")");
}

/// One row an effect, one column a channel: by how much the distortion falls without it.
void addFalls(Page& page, const DistortionByEffect& distortion)
{
    constexpr double full = 20.0;  // dB that fill the bar
    std::vector<std::string> header {"Without"};
    for (const auto& channel : distortion.whole)
        header.push_back(capitalized(name(channel.quantity)) + ", " + decibels(distortionDb(channel)));
    std::vector<std::vector<Page::Cell>> rows;
    for (const auto& effect : distortion.effects) {
        std::vector<Page::Cell> row {effectTitle(effect.effect)};
        for (const auto& channel : distortion.whole) {
            const double fall = fallWithout(distortion, effect, channel.quantity);
            row.push_back(std::isfinite(fall) ? Page::Cell::bar(fall / full, decibels(-fall)) : Page::Cell("\u2013"));
        }
        rows.push_back(std::move(row));
    }
    page.table(header, rows);
    page.note(
        "The header gives the distortion of the whole model, even and odd together, over the channel's power; a row "
        "the change when that effect is switched off. Effects need not add up: some cancel, and some make the others' "
        "excursion.");
}

}  // namespace

void addWhatIf(Page& page, const LadderFile& file)
{
    if (!file.whatIf)
        return;
    const auto& [distortion, stroke] = *file.whatIf;
    page.section("What makes the distortion, and what limits the stroke");
    page.paragraph(advice(*file.whatIf));
    addFalls(page, distortion);
    auto plots = distortionPlots(distortion);
    page.figures(std::move(plots), "Even and odd distortion together over the signal in each band, at "
                                       + nominal(distortion.level, file.ladder.model().electrical() ? "V" : "N")
                                       + " rms: of the whole model, and of the effects that alone make most.");
    std::vector<std::vector<Page::Cell>> rows;
    for (const auto& limit : stroke.limits)
        rows.push_back({capitalized(limit.name) + " " + limit.criterion, side(limit.inward, limit.inwardEnd),
                        side(limit.outward, limit.outwardEnd)});
    page.table({"Limit", "Inward", "Outward"}, rows);
    page.note("Within the " + engineering(stroke.range, "m", 3)
              + " that were measured either way; impedance and Doppler shift at " + engineering(stroke.tone, "Hz", 3)
              + ", 8.5 times the resonance. In brackets: what there is at the end of the range.");
    if (withKnown(file.ladder.model(), {}).motionIsGuessed)
        page.note(
            "All lengths are in a unit of their own: voltage and current alone do not show how far the cone moves, "
            "and the moving mass is a guess.");
    std::vector<std::pair<std::string, std::string>> facts;
    if (stroke.gapCentre)
        facts.emplace_back("Middle of the gap, from the coil's rest",
                           withError(stroke.gapCentre->value, stroke.gapCentre->standardError, "m"));
    if (stroke.stiffnessAsymmetry)
        facts.emplace_back("Stiffness, inward over outward",
                           withError(stroke.stiffnessAsymmetry->value, stroke.stiffnessAsymmetry->standardError, "%"));
    if (!facts.empty())
        page.facts(facts);
}

}  // namespace excursion
