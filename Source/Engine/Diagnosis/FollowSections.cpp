// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/FollowSections.h"

#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/QuickFit.h"
#include "Engine/Diagnosis/Sums.h"
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

bool sectionsExplain(Model model, const Record& record, int substeps)
{
    if (record.sectionsDrift || !record.noiseKnown || !hasPeriods(record) || record.levels.size() < 2)
        return false;
    const auto plain = tryCompare(model, record, {substeps, false});
    if (!plain || isNoise(*plain))
        return false;
    auto followed = record;
    followed.sectionsDrift = true;
    FitOptions options;
    options.substeps = substeps;
    options.fedGradient = true;
    options.search = {10, 1e-3};
    if (!fitFed(model, followed, estimationSections(followed), options).usable())
        return false;
    const auto rest = tryCompare(model, followed, {substeps, false});
    constexpr double clearly = 1.3;  // times less
    return rest && rest->sectionMoves && rest->sectionMoves->areSmall()
           && (isNoise(*rest) || rest->chiSquaredPerValue < std::min(atNoise, plain->chiSquaredPerValue / clearly));
}

}  // namespace excursion
