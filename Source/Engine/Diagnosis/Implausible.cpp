// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/FindAnew.h"
#include "Engine/Diagnosis/WholeSearch.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FeedbackError.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace excursion {

std::set<std::string> implausibleIn(const Model& model)
{
    std::set<std::string> found;
    for (std::size_t k = 1; k < model.components.size(); ++k)
        if (!isPlausible(model, k))
            found.insert(model.components[k].effect->id());
    return found;
}

bool WholeSearch::restImplausibleParts(Model& model) const
{
    bool any = false;
    for (std::size_t k = 1; k < model.components.size(); ++k)
        if (!base_.has(model.components[k].effect->id()))
            any |= excursion::restImplausibleParts(model, k);
    return any;
}

std::set<std::string> WholeSearch::takeOutImplausible(Model& model) const
{
    auto leaner = model;
    if (restImplausibleParts(leaner)) {
        if (!fit(leaner, brief).usable())
            return {};
        model = leaner;
    }
    const auto strange = strangeIn(leaner);
    if (strange.empty())
        return {};
    if (left(leaner).isNoise())
        return takeOutOneByOne(model);
    for (const auto& effect : strange)
        leaner = withoutEffect(leaner, effect);
    if (!fit(leaner, brief).usable())
        return {};
    model = std::move(leaner);
    return strange;
}

std::set<std::string> WholeSearch::takeOutOneByOne(Model& model) const
{
    auto leaner = model;
    std::set<std::string> gone, anew;
    for (auto strange = strangeIn(leaner); !strange.empty(); strange = strangeIn(leaner)) {
        auto next = withoutOneOf(strange, leaner);
        if (!next || !fit(next->model, brief).usable())
            break;
        if (anew.insert(next->effect).second && bringBack(leaner, next->effect, left(next->model)))
            continue;
        gone.insert(next->effect);
        leaner = std::move(next->model);
    }
    if (!anew.empty())
        model = std::move(leaner);
    return gone;
}

/// Where others have bent a linear effect far away no small step leads back.
bool WholeSearch::bringBack(Model& model, const std::string& effect, const Left& without) const
{
    return effectNamed(effect).linear() && lost(without, left(model)) > barelyMissed
           && findAnew(
               model, LinearResponses(withoutLaws(model, record_, options_.threads)),
               [&](const Component& component) { return component.effect->id() == effect; },
               [&](Model& anew) {
                   return fit(anew, brief).usable() && !strangeIn(anew).contains(effect)
                          && lost(without, left(anew)) > hardlyNeeded;
               });
}

std::set<std::string> WholeSearch::strangeIn(const Model& model) const
{
    auto strange = implausibleIn(model);
    std::erase_if(strange, [&](const std::string& effect) { return base_.has(effect); });
    return strange;
}

/// Whether an effect is strange that a model had not before.
bool WholeSearch::hasBecomeStrange(const Model& model, const Model& before) const
{
    const auto strange = strangeIn(model);
    return std::any_of(strange.begin(), strange.end(), [&](const std::string& effect) { return !before.has(effect); });
}

std::optional<WholeSearch::Leaner> WholeSearch::withoutOneOf(const std::set<std::string>& effects,
                                                             const Model& model) const
{
    if (effects.size() == 1)
        return Leaner {*effects.begin(), withoutEffect(model, *effects.begin())};
    std::optional<Leaner> best;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& effect : effects) {
        auto leaner = withoutEffect(model, effect);
        if (!fit(leaner, glance).usable())
            continue;
        if (const double then = left(leaner).chiSquaredPerValue; then < least) {
            least = then;
            best = {effect, std::move(leaner)};
        }
    }
    return best;
}

}  // namespace excursion
