// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/QuickFit.h"

#include "Engine/Diagnosis/Compare.h"
#include "Engine/Loudspeaker/FeedbackError.h"
#include "Engine/Loudspeaker/OutputError.h"

#include <cmath>
#include <limits>

namespace excursion {
namespace {

/// The cost of a model that leaves this, infinite where it runs away.
double costOf(const Model& model, std::optional<NormalEquations> sum)
{
    if (!sum)
        return std::numeric_limits<double>::infinity();
    addPrior(model, freeParameters(model), *sum);
    return sum->cost;
}

OutputErrorOptions withoutGradient(const FitOptions& options)
{
    OutputErrorOptions run;
    run.gradient = false;
    run.played = options.fedGradient;
    run.sectionsDrift = options.sectionsDrift;
    run.substeps = options.substeps;
    run.threads = options.threads;
    return run;
}

}  // namespace

std::optional<NormalEquations> quickSum(const Model& model, const Record& record,
                                        const std::vector<std::size_t>& sections, const FitOptions& options)
{
    return sumOf(quickError(model, record, sections, {}, withoutGradient(options)));
}

double quickCost(const Model& model, const Record& record, const std::vector<std::size_t>& sections,
                 const FitOptions& options)
{
    return costOf(model, quickSum(model, record, sections, options));
}

bool canBeSimulated(const Model& model, const Record& record, const std::vector<std::size_t>& sections,
                    const FitOptions& options)
{
    return std::isfinite(costOf(model, sumOf(outputError(model, record, sections, {}, withoutGradient(options)))));
}

void chooseResiduals(FitOptions& fit, ScoreOptions& score, const Model& model, const Record& record,
                     const std::vector<std::size_t>& sections)
{
    if (fit.substeps == 0)
        fit.substeps = substepsFor(model, record, fit.simulationTolerance);
    score.substeps = fit.substeps;
    fit.fedGradient = score.played = isBetterPlayed(model, record, sections, withoutGradient(fit));
}

FitSummary quickFit(Model& model, const Record& record, const std::vector<std::size_t>& sections,
                    const FitOptions& options, const Progress& progress)
{
    auto fed = options;
    fed.fed = true;
    fed.fedGradient = false;
    if (!options.fedGradient)
        return fit(model, record, sections, fed, progress);
    // While fed laws leave much more than a simulation their fit goes astray.
    constexpr double astray = 3.0;
    const double now = quickCost(model, record, sections, options);
    if (auto found = model; quickCost(model, record, sections, fed) < astray * now
                            && fit(found, record, sections, fed, progress.part(0.0, 0.2)).usable()
                            && quickCost(found, record, sections, options) < now)
        model = std::move(found);
    auto played = options;
    played.fed = false;
    return fit(model, record, sections, played, progress.part(0.2, 1.0));
}

FitSummary fitFed(Model& model, const Record& record, const std::vector<std::size_t>& sections, FitOptions options,
                  const Progress& progress)
{
    auto found = model;
    auto summary = quickFit(found, record, sections, options, progress);
    options.fed = false;
    if (hasPeriods(record) && !(summary.usable() && canBeSimulated(found, record, sections, options)))
        return fit(model, record, sections, options, progress);
    model = std::move(found);
    return summary;
}

}  // namespace excursion
