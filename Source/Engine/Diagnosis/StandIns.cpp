// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Trial.h"
#include "Engine/Diagnosis/WholeSearch.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FeedbackError.h"
#include "Engine/Loudspeaker/Seen.h"

#include <utility>

namespace excursion {
namespace {

constexpr LeastSquaresOptions onTrial {5, 1e-2};
constexpr double clean = 1.05;    // mean squared residual that leaves another effect nothing to explain
constexpr double hopeless = 4.0;  // times what is left with the effect that may stand in: no fit would make that good

}  // namespace

bool WholeSearch::exchangeStandIns(Model& model) const
{
    auto now = left(model);
    if (now.chiSquaredPerValue < clean)
        return false;
    const auto seen = seenIn(record_);
    const auto range = visitedRange(model, record_, test_.degree);
    const LinearResponses still(withoutLaws(model, record_, options_.threads));
    const auto isBetter = [&](Model& other) {
        if (!fitNewestByResponse(other, still.gridFor(other.components.back())).usable()
            || left(other).chiSquaredPerValue > hopeless * now.chiSquaredPerValue || !fit(other, onTrial).usable()
            || !strangeIn(other).empty())
            return false;
        auto then = left(other);
        const bool better = then.chiSquaredPerValue < now.chiSquaredPerValue && lost(now, then) > hardlyNeeded;
        if (better)
            now = std::move(then);
        return better;
    };
    bool any = false;
    for (const auto& id : model.effectIds()) {
        if (base_.has(id) || !effectNamed(id).linear())
            continue;
        for (const auto* effect : catalogue()) {
            if (!effect->linear() || model.has(effect->id()) || !whyUnseen(*effect, seen).empty())
                continue;
            auto other = withEffect(withoutEffect(model, id), *effect, range);
            if (!isBetter(other))
                continue;
            model = std::move(other);
            any = true;
            break;
        }
    }
    return any;
}

}  // namespace excursion
