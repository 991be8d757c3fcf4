// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/LawDegrees.h"

#include "Engine/Diagnosis/QuickFit.h"
#include "Engine/Diagnosis/RaiseDegrees.h"

#include <algorithm>

namespace excursion {
namespace {

/// Whether laws of a higher degree leave so much less that it pays for their coefficients: what the slopes of fed laws
/// promise need not come.
bool paysForItself(const Model& higher, const Model& model, const Record& record,
                   const std::vector<std::size_t>& sections, const FitOptions& options)
{
    const auto now = quickSum(model, record, sections, options), then = quickSum(higher, record, sections, options);
    if (!now || !then)
        return then.has_value();
    const double unit = std::max(1.0, then->cost / std::max(1.0, then->rows)),
                 more = static_cast<double>(freeParameters(higher).size())
                        - static_cast<double>(freeParameters(model).size());
    return now->cost - then->cost > priceOfCoefficient * unit * more;
}

}  // namespace

std::optional<FitSummary> raiseAsItPays(Model& model, const Record& record, const std::vector<std::size_t>& sections,
                                        const FitOptions& options, const ScoreOptions& score, double share,
                                        const Progress& progress)
{
    std::optional<FitSummary> last;
    constexpr int mostRaises = 3;
    for (int n = 0; n < mostRaises; ++n) {
        auto higher = model;
        if (raiseDegrees(higher, record, score, share).empty())
            break;
        const auto part = progress.part(static_cast<double>(n) / mostRaises, (n + 1.0) / mostRaises);
        const auto next = fitFed(higher, record, sections, options, part);
        if (!next.usable() || !paysForItself(higher, model, record, sections, options))
            break;
        model = std::move(higher);
        last = next;
    }
    return last;
}

std::optional<FitSummary> lowerAsItPays(Model& model, const Record& record, const std::vector<std::size_t>& sections,
                                        const FitOptions& options, const Progress& progress)
{
    std::optional<FitSummary> last;
    for (const auto k : tooHigh(model)) {
        constexpr int by = 4;
        auto lower = withDegree(model, k, model.components[k].operatingRange.degree - by);
        const auto next = fitFed(lower, record, sections, options, progress);
        if (!next.usable() || paysForItself(model, lower, record, sections, options))
            continue;
        model = std::move(lower);
        last = next;
    }
    return last;
}

}  // namespace excursion
