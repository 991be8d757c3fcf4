// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/FindCoupling.h"

#include "Engine/Diagnosis/Score.h"
#include "Engine/Diagnosis/Sums.h"
#include "Engine/Diagnosis/QuickFit.h"
#include "Engine/Estimate/Coupling.h"
#include "Engine/Loudspeaker/FeedbackError.h"
#include "Engine/Loudspeaker/OutputError.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {
namespace {

/// What a model leaves behind a coupling.
class Coupled {
public:
    Coupled(const Model& model, const Record& record, const FitOptions& options)
        : record_(record), sections_(trialSections(record, 2)), options_(options)
    {
        ScoreOptions score;
        score.threads = options.threads;
        chooseResiduals(options_, score, model, record, sections_);
        options_.search = {4, 1e-3};
        run_ = score.run();
    }

    /// The cost after one step of all that is free; infinite where the model runs away.
    double afterAStep(const Model& model, double corner, const Progress& progress) const
    {
        const auto active = freeParameters(model);
        auto sum = sumOf(quickError(model, behind(corner), sections_, active, run_, progress));
        if (!sum)
            return std::numeric_limits<double>::infinity();
        addPrior(model, active, *sum);
        return predictedCost(*sum, gaussNewtonStep(*sum));
    }
    FitSummary fit(Model& model, double corner, const Progress& progress) const
    {
        return quickFit(model, behind(corner), sections_, options_, progress);
    }

private:
    Record behind(double corner) const
    {
        auto record = record_;
        uncouple(record, corner);
        return record;
    }

    const Record& record_;
    std::vector<std::size_t> sections_;
    FitOptions options_;
    OutputErrorOptions run_;
};

}  // namespace

double findCoupling(const Model& model, const Record& record, const FitOptions& options, double enough,
                    const Progress& progress)
{
    if (!hasPeriods(record) || !record.noiseKnown || !hasLaws(model))
        return 0.0;
    const Coupled coupled(model, record, options);
    constexpr double first = 0.03, worthwhile = 0.05, settled = 0.02, highest = 2.0;
    constexpr int rounds = 4;
    Model now = model;
    FitSummary before, after;
    double corner = 0.0, reach = first * record.bandLow;
    for (int n = 0; n < rounds; ++n) {
        progress.at(static_cast<double>(n) / rounds, "looking for the recorder's coupling");
        const auto part = progress.part(static_cast<double>(n) / rounds, static_cast<double>(n) / rounds);
        const double here = coupled.afterAStep(now, corner, part);
        const double below = coupled.afterAStep(now, corner - reach, part);
        const double above = coupled.afterAStep(now, corner + reach, part);
        const double bend = below - 2.0 * here + above;
        if (!(bend > 0.0) || !std::isfinite(bend))
            break;
        const double step = 0.5 * reach * (below - above) / bend, promised = 0.5 * bend * std::pow(step / reach, 2);
        if (n == 0) {
            if (step <= 0.0 || promised < worthwhile * here)
                return 0.0;
            before = after = coupled.fit(now, corner, part);
            if (!before.usable())
                return 0.0;
        }
        const double next = std::clamp(corner + step, 0.0, highest * record.bandLow);
        Model there = now;
        const auto fitted = coupled.fit(there, next, part);
        if (!fitted.usable() || !(fitted.finalCost < after.finalCost))
            break;
        const bool arrived = std::abs(next - corner) < settled * next;
        now = std::move(there);
        after = fitted;
        corner = next;
        if (arrived)
            break;
        reach = std::max(0.1 * corner, 0.3 * reach);
    }
    if (!(corner > 0.0))
        return 0.0;
    const double fall = after.chiSquaredPerValue / before.chiSquaredPerValue;
    constexpr double clearly = 0.8;
    const bool toTheNoise = after.chiSquaredPerValue < atNoise && after.onlyNoise && fall < clearly;
    return toTheNoise || fall < enough ? corner : 0.0;
}

}  // namespace excursion
