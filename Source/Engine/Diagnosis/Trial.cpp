// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Trial.h"

#include "Engine/Diagnosis/QuickFit.h"

#include <algorithm>
#include <functional>
#include <optional>

namespace excursion {
namespace {

/// The strengths of the newest component times a factor.
Model newestScaled(Model model, double factor)
{
    model.components.back() = scaled(std::move(model.components.back()), factor);
    return model;
}

/// The newest component with the largest share of its step that leaves less: the whole may be too long for the
/// simulation. None where no share does.
std::optional<Model> largestShare(const Model& model, const std::function<bool(const Model&)>& leavesLess)
{
    for (const double share : {1.0, 0.5, 0.2, 0.05})
        if (auto candidate = newestScaled(model, share); leavesLess(candidate))
            return candidate;
    return std::nullopt;
}

}  // namespace

bool helps(const Score& proposed, const Record& record, const std::vector<std::size_t>& sections,
           const FitOptions& options)
{
    const auto left = [&](const Model& candidate) { return quickCost(candidate, record, sections, options); };
    const double still = left(newestScaled(proposed.model, 0.0));
    return (!proposed.byResponse.components.empty() && left(proposed.byResponse) < still)
           || largestShare(proposed.model, [&](const Model& candidate) { return left(candidate) < still; });
}

FitSummary tryFit(Model& model, const Score& proposed, const Record& record, const std::vector<std::size_t>& sections,
                  const FitOptions& options, const Progress& progress)
{
    model = proposed.model;
    FitOptions chosen = options;
    if (chosen.substeps == 0)
        chosen.substeps = substepsFor(model, record, options.simulationTolerance);
    const auto left = [&](const Model& candidate) { return quickCost(candidate, record, sections, chosen); };
    const bool simulated = chosen.fedGradient || !hasPeriods(record);  // what left() tells
    Model best = newestScaled(model, 0.0);
    double lowest = left(best);
    const auto shortened = largestShare(model, [&](const Model& candidate) {
        const double cost = left(candidate);
        const bool does = cost < lowest && (simulated || canBeSimulated(candidate, record, sections, chosen));
        if (does)
            lowest = cost;
        return does;
    });
    if (shortened)
        best = *shortened;
    // A linear effect shows in the frequency response alone; in time it would creep along the curved valley in which
    // relaxations trade off against the stiffness. Beside laws the responses tell no more than where that valley is, so
    // what they say may leave a little more at first.
    constexpr double near = 2.0, worthIt = 0.8;
    if (!proposed.byResponse.components.empty() && left(proposed.byResponse) < near * lowest) {
        model = proposed.byResponse;
        auto summary = fitFed(model, record, sections, chosen, progress);
        if (summary.usable() && left(model) < worthIt * lowest)
            return summary;
    }
    model = std::move(best);
    return fitFed(model, record, sections, chosen, progress);
}

FitSummary tryEffect(Model& model, const Record& record, const Effect& effect, const FitOptions& options,
                     const Progress& progress)
{
    ScoreOptions test;
    test.substeps = substepsFor(model, record, options.simulationTolerance);
    test.threads = options.threads;
    const auto scores = score(model, record, test, progress.part(0.0, 0.4)).scores;
    const auto start = std::find_if(scores.begin(), scores.end(), [&](const Score& s) { return s.effect == &effect; });
    if (start == scores.end())
        throw Error(Error::Kind::data, "This take cannot say anything about the effect \"" + effect.id()
                                           + "\" besides those that the model has.");
    FitOptions quick = options;
    quick.substeps = test.substeps;
    quick.search = {10, 3e-3};
    return tryFit(model, *start, record, trialSections(record, 2), quick, progress.part(0.4, 1.0));
}

}  // namespace excursion
