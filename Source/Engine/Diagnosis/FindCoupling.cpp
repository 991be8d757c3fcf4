// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/FindCoupling.h"

#include "Engine/Diagnosis/Score.h"
#include "Engine/Diagnosis/Sums.h"
#include "Engine/Diagnosis/QuickFit.h"
#include "Engine/Estimate/Coupling.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {
namespace {

/// What a model leaves behind a coupling, fitted quickly.
class Coupled {
public:
    Coupled(const Model& model, const Record& record, const FitOptions& options)
        : model_(model), record_(record), sections_(estimationSections(record)), options_(options)
    {
        ScoreOptions score;
        score.threads = options.threads;
        chooseResiduals(options_, score, model, record, sections_);
        options_.search = {4, 1e-3};
    }

    FitSummary at(double corner, const Progress& progress) const
    {
        auto record = record_;
        uncouple(record, corner);
        auto model = model_;
        return quickFit(model, record, sections_, options_, progress);
    }
    double costAt(double corner, const Progress& progress) const
    {
        const auto summary = at(corner, progress);
        return summary.usable() ? summary.finalCost : std::numeric_limits<double>::infinity();
    }

private:
    const Model& model_;
    const Record& record_;
    std::vector<std::size_t> sections_;
    FitOptions options_;
};

}  // namespace

double findCoupling(const Model& model, const Record& record, const FitOptions& options, bool allElseIsFound,
                    const Progress& progress)
{
    if (!hasPeriods(record) || !record.noiseKnown || !hasLaws(model))
        return 0.0;
    const Coupled coupled(model, record, options);
    const auto before = coupled.at(0.0, progress.part(0.0, 0.0));
    if (!before.usable())
        return 0.0;
    constexpr double first = 0.03, worthwhile = 0.05, settled = 0.02, highest = 2.0;
    constexpr int rounds = 4;
    double corner = 0.0, cost = before.finalCost, reach = first * record.bandLow;
    for (int n = 0; n < rounds; ++n) {
        progress.at(static_cast<double>(n) / rounds, "looking for the recorder's coupling");
        const auto part = progress.part(static_cast<double>(n) / rounds, static_cast<double>(n) / rounds);
        const double below = coupled.costAt(corner - reach, part), above = coupled.costAt(corner + reach, part);
        const double bend = below - 2.0 * cost + above;
        if (!(bend > 0.0) || !std::isfinite(bend))
            break;
        const double step = 0.5 * reach * (below - above) / bend, promised = 0.5 * bend * std::pow(step / reach, 2);
        if (n == 0 && (step <= 0.0 || promised < worthwhile * cost))
            return 0.0;
        const double next = std::clamp(corner + step, 0.0, highest * record.bandLow);
        const double there = coupled.costAt(next, part);
        if (!(there < cost))
            break;
        const bool arrived = std::abs(next - corner) < settled * next;
        corner = next;
        cost = there;
        if (arrived)
            break;
        reach = std::max(0.1 * corner, 0.3 * reach);
    }
    const auto after = coupled.at(corner, progress.part(1.0, 1.0));
    const double fall = after.chiSquaredPerValue / before.chiSquaredPerValue;
    constexpr double halved = 0.5, clearly = 0.8;
    const bool toTheNoise = after.chiSquaredPerValue < atNoise && after.onlyNoise && fall < clearly;
    return corner > 0.0 && (toTheNoise || (allElseIsFound && fall < halved)) ? corner : 0.0;
}

}  // namespace excursion
