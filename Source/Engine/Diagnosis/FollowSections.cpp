// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/FollowSections.h"

#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/QuickFit.h"
#include "Engine/Diagnosis/Sums.h"

#include <utility>

namespace excursion {

namespace {

Record followed(Record record)
{
    record.sectionsDrift = true;
    return record;
}

/// Whether moves that are followed leave noise, or so much less that something else is missing beside them.
bool explain(const Comparison& with, const Comparison& without)
{
    constexpr double clearly = 1.3, farFromNoise = 2.0;  // times less
    if (!with.sectionMoves || !with.sectionMoves->areSmall())
        return false;
    const double times = with.chiSquaredPerValue < atNoise ? clearly : farFromNoise;
    return isNoise(with) || with.chiSquaredPerValue * times < without.chiSquaredPerValue;
}

/// What is left without moves; none where that is noise, or moves cannot be told.
std::optional<Comparison> leftWithout(const Model& model, const Record& record, int substeps, const Progress& progress)
{
    auto plain = tellsMoves(record) ? tryCompare(model, record, {substeps, false}, progress.silent()) : std::nullopt;
    if (plain && isNoise(*plain))
        plain.reset();
    return plain;
}

}  // namespace

bool tellsMoves(const Record& record)
{
    return !record.sectionsDrift && record.noiseKnown && hasPeriods(record) && record.levels.size() > 1;
}

bool movesExplain(const Model& model, const Record& record, int substeps, const Progress& progress)
{
    const auto without = leftWithout(model, record, substeps, progress);
    if (!without)
        return false;
    const auto with = tryCompare(model, followed(record), {substeps, false}, progress.silent());
    return with && explain(*with, *without);
}

std::optional<Following> followingSections(Model model, const Record& record, int substeps, const Progress& progress)
{
    constexpr double most = 0.75;  // of what is left over the noise without a fit
    const auto without = leftWithout(model, record, substeps, progress);
    if (!without)
        return std::nullopt;
    const auto moving = followed(record);
    const auto glimpse = tryCompare(model, moving, {substeps, false}, progress.silent());
    if (!glimpse || glimpse->chiSquaredPerValue - sureNoise > most * (without->chiSquaredPerValue - sureNoise))
        return std::nullopt;
    FitOptions options;
    options.substeps = substeps;
    options.fedGradient = true;
    options.search = {10, 1e-3};
    const auto fit = fitFed(model, moving, estimationSections(moving), options, progress.silent());
    const auto with = fit.usable() ? tryCompare(model, moving, {substeps, false}, progress.silent()) : std::nullopt;
    if (!with || !explain(*with, *without))
        return std::nullopt;
    return Following {std::move(model), fit};
}

}  // namespace excursion
