// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/FollowSections.h"

#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/QuickFit.h"
#include "Engine/Diagnosis/Sums.h"

#include <algorithm>

namespace excursion {

bool tellsMoves(const Record& record)
{
    return !record.sectionsDrift && record.noiseKnown && hasPeriods(record) && record.levels.size() > 1;
}

std::optional<Model> followingSections(Model model, const Record& record, int substeps, const Progress& progress)
{
    constexpr double most = 0.75;                        // of what is left over the noise without a fit
    constexpr double clearly = 1.3, farFromNoise = 2.0;  // times less after it
    if (!tellsMoves(record))
        return std::nullopt;
    const auto plain = tryCompare(model, record, {substeps, false}, progress.silent());
    if (!plain || isNoise(*plain))
        return std::nullopt;
    auto followed = record;
    followed.sectionsDrift = true;
    const auto glimpse = tryCompare(model, followed, {substeps, false}, progress.silent());
    if (!glimpse || glimpse->chiSquaredPerValue - sureNoise > most * (plain->chiSquaredPerValue - sureNoise))
        return std::nullopt;
    FitOptions options;
    options.substeps = substeps;
    options.fedGradient = true;
    options.search = {10, 1e-3};
    if (!fitFed(model, followed, estimationSections(followed), options, progress.silent()).usable())
        return std::nullopt;
    const auto rest = tryCompare(model, followed, {substeps, false}, progress.silent());
    if (!rest || !rest->sectionMoves || !rest->sectionMoves->areSmall())
        return std::nullopt;
    const double times = rest->chiSquaredPerValue < atNoise ? clearly : farFromNoise;
    if (!isNoise(*rest) && rest->chiSquaredPerValue * times > plain->chiSquaredPerValue)
        return std::nullopt;
    return model;
}

}  // namespace excursion
