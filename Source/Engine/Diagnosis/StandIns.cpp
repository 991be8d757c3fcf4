// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/QuickFit.h"
#include "Engine/Diagnosis/WholeSearch.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FeedbackError.h"
#include "Engine/Loudspeaker/Seen.h"
#include "Engine/Numerics/Parallel.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

namespace excursion {
namespace {

constexpr LeastSquaresOptions onTrial {5, 1e-2};
constexpr double worthIt = 0.98;                       // of the mean squared residual
constexpr double hardlyMore = 1.01, convincing = 3.0;  // of the mean squared residual; dB of a channel's power
constexpr double clean = 1.05;    // mean squared residual that leaves another effect nothing to explain
constexpr double dearer = 1.0;    // dB that more parameters must bring
constexpr double hopeless = 4.0;  // times what is left with the effect that may stand in: no fit would make that good

/// A search for the newest effect on responses. Whether it came to something.
bool findNewest(Model& model, const LinearResponses& still)
{
    return fitNewestByResponse(model, still.gridFor(model.components.back())).usable();
}

std::size_t leastOf(const std::vector<double>& values)
{
    return static_cast<std::size_t>(std::min_element(values.begin(), values.end()) - values.begin());
}

bool newestIsPlausible(const Model& model) { return isPlausible(model, model.components.size() - 1); }

}  // namespace

Model WholeSearch::withLinear(const std::vector<const Effect*>& effects, Model model, const Progress& progress) const
{
    const auto range = visitedRange(model, record_, test_.degree);
    const LinearResponses still(withoutLaws(model, record_, options_.threads));
    auto now = left(model);
    auto missing = effects;
    std::optional<Model> sure;  // as it was before an effect came in on trust
    constexpr double never = std::numeric_limits<double>::infinity();
    // The mean over all lines hardly tells of what lies in a few of them.
    const auto brings = [&](const Left& then) {
        return then.chiSquaredPerValue < worthIt * now.chiSquaredPerValue
               || (then.chiSquaredPerValue < hardlyMore * now.chiSquaredPerValue && lost(now, then) > convincing);
    };
    while (!missing.empty()) {
        std::vector<Model> with;
        for (const auto* effect : missing)
            with.push_back(withEffect(model, *effect, range));
        std::vector<char> found(with.size());
        inParallel(with.size(), options_.threads, progress, [&](std::size_t n) {
            found[n] = findNewest(with[n], still);
            return true;
        });
        std::vector<Left> then(with.size());
        std::vector<double> leaves, surely;  // of those that bring something; the latter of plausible ones alone
        for (std::size_t n = 0; n < with.size(); ++n) {
            if (found[n])
                then[n] = left(with[n]);
            leaves.push_back(found[n] && brings(then[n]) ? then[n].chiSquaredPerValue : never);
            surely.push_back(newestIsPlausible(with[n]) ? leaves[n] : never);
        }
        auto best = leastOf(surely);
        if (surely[best] == never) {
            // One that is bent by what another effect would explain comes right beside that one.
            best = leastOf(leaves);
            if (leaves[best] == never)
                break;
            if (!sure)
                sure = model;
        }
        std::vector<const Effect*> others;  // that may still bring something
        for (std::size_t n = 0; n < with.size(); ++n)
            if (n != best && found[n] && (leaves[n] < never || then[n].chiSquaredPerValue < now.chiSquaredPerValue))
                others.push_back(missing[n]);
        if (sure) {  // also what brought nothing beside those before
            others = effects;
            std::erase_if(others, [&](const Effect* effect) { return with[best].has(effect->id()); });
        }
        model = std::move(with[best]);
        now = std::move(then[best]);
        missing = std::move(others);
        if (sure && !hasBecomeStrange(model, *sure))
            sure.reset();
    }
    return sure ? *sure : model;
}

bool WholeSearch::exchangeStandIns(Model& model, const Progress& progress)
{
    chooseResiduals(model);
    auto now = left(model);
    const auto ids = model.effectIds();
    const auto seen = seenIn(record_);
    const bool feltIsSeen = std::any_of(seen.channels.begin(), seen.channels.end(), [](Quantity q) {
        return q != Quantity::pressure && q != Quantity::voltage && q != Quantity::force;
    });
    // a felt resonance that could be one that is only heard, where what is felt would show
    const auto isSuspect = [&](const std::string& id) { return feltIsSeen && !base_.has(id) && mayStandIn(model, id); };
    const auto isOnlyHeard = [&](const Effect* effect) {
        return effect->linear() && !effect->felt() && !model.has(effect->id()) && whyUnseen(*effect, seen).empty();
    };
    if (now.chiSquaredPerValue < clean
        && (std::none_of(ids.begin(), ids.end(), isSuspect)
            || std::none_of(catalogue().begin(), catalogue().end(), isOnlyHeard)))
        return false;
    if (auto settled = model; fit(settled, onTrial, progress).usable())  // as what it is compared with
        if (auto then = left(settled); then.chiSquaredPerValue < now.chiSquaredPerValue) {
            model = std::move(settled);
            now = std::move(then);
        }
    const auto range = visitedRange(model, record_, test_.degree);
    const LinearResponses still(withoutLaws(model, record_, options_.threads));
    const Progress stoppable = progress.part(0.0, 0.0);
    // dB by which the other leaves less, minus what an exchange has to bring. What is only heard claims less than what
    // is felt, so it need bring nothing.
    const auto gainOf = [&](Model& other, bool claimsLess) {
        constexpr double none = 0.0;
        if (!findNewest(other, still) || !newestIsPlausible(other)
            || left(other).chiSquaredPerValue > hopeless * now.chiSquaredPerValue
            || !fit(other, onTrial, stoppable).usable() || !strangeIn(other).empty())
            return none;
        const auto then = left(other);
        if (claimsLess && lost(then, now) < hardlyNeeded)
            return hardlyNeeded - lost(then, now);
        const double price = freeParameters(other).size() > freeParameters(model).size() ? dearer : hardlyNeeded;
        return then.chiSquaredPerValue < now.chiSquaredPerValue ? lost(now, then) - price : none;
    };
    bool any = false;
    for (const auto& id : ids) {
        const bool suspect = isSuspect(id), isClean = now.chiSquaredPerValue < clean;
        if (base_.has(id) || !effectNamed(id).linear() || (isClean && !suspect))
            continue;
        std::optional<Model> best;
        double most = 0.0;
        for (const auto* effect : catalogue()) {
            const bool claimsLess = suspect && isOnlyHeard(effect);
            if (!effect->linear() || model.has(effect->id()) || (isClean && !claimsLess)
                || !whyUnseen(*effect, seen).empty())
                continue;
            auto other = withEffect(withoutEffect(model, id), *effect, range);
            if (const double gain = gainOf(other, claimsLess); gain > most) {
                most = gain;
                best = std::move(other);
            }
        }
        if (best) {
            model = std::move(*best);
            now = left(model);
            any = true;
        }
    }
    return any;
}

}  // namespace excursion
