// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/FollowSections.h"

#include "Engine/Diagnosis/Compare.h"
#include "Engine/Document/Figures.h"

#include <algorithm>

namespace excursion {

SectionMoves movesOf(const std::vector<SectionFit>& fits)
{
    const auto range = [&](double SectionDrift::Amount::*part) {
        const auto [least, most] = std::minmax_element(
            fits.begin(), fits.end(),
            [&](const SectionFit& a, const SectionFit& b) { return a.drift.*part < b.drift.*part; });
        return fits.empty() ? 0.0 : most->drift.*part - least->drift.*part;
    };
    return {range(&SectionDrift::Amount::stiffness), range(&SectionDrift::Amount::resistance)};
}

std::string inWords(const SectionMoves& moves)
{
    return "the stiffness moves by " + figure(100.0 * moves.stiffness, "%.2g") + " % and the resistance by "
           + figure(100.0 * moves.resistance, "%.2g") + " %";
}

bool sectionsExplain(const Model& model, const Record& record, int substeps)
{
    if (record.sectionsDrift || !record.noiseKnown || !hasPeriods(record) || record.sections.size() < 2)
        return false;
    const auto plain = tryCompare(model, record, {substeps, false});
    if (!plain || isNoise(*plain))
        return false;
    auto followed = record;
    followed.sectionsDrift = true;
    const auto rest = tryCompare(model, followed, {substeps, false});
    return rest && isNoise(*rest) && rest->sectionMoves && rest->sectionMoves->areSmall();
}

}  // namespace excursion
