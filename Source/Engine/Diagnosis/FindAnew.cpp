// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/FindAnew.h"

#include "Engine/Diagnosis/QuickFit.h"
#include "Engine/Loudspeaker/FeedbackError.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {
namespace {

/// Shapes of a linear effect that are next to nothing, but not from the start, at a share of where they start. Whether
/// there are any.
bool wakeShapesOf(Component& component)
{
    constexpr double nothing = 0.05, share = 0.15;
    bool any = false;
    if (!component.effect->linear() || !isAtWork(component))
        return any;
    const auto usual = component.effect->parameters(component.operatingRange);
    for (std::size_t k = 0; k < usual.size(); ++k) {
        auto& p = component.parameters[k];
        if (p.strength || !p.free || !std::isfinite(p.prior)
            || !(std::abs(p.value) < nothing * std::abs(usual[k].value)))
            continue;
        p.value = share * usual[k].value;
        any = true;
    }
    return any;
}

/// Whether a cost is less than a share of the lowest one; it is the lowest one then.
bool falls(double& lowest, double cost, double share)
{
    const bool does = cost < share * lowest;
    if (does)
        lowest = cost;
    return does;
}

/// Changes one component after the other, on trial. Whether a change was kept.
/// @param change  of component k; false if there is nothing to change
bool changeEach(Model& model, const std::function<bool(Model& anew, std::size_t k)>& change,
                const std::function<bool(Model& anew)>& keeps)
{
    bool any = false;
    for (std::size_t k = 1; k < model.components.size(); ++k) {
        auto anew = model;
        if (!change(anew, k) || !keeps(anew))
            continue;
        model = std::move(anew);
        any = true;
    }
    return any;
}

}  // namespace

bool findAnew(Model& model, const LinearResponses& still, const std::function<bool(const Component&)>& which,
              const std::function<bool(Model& anew)>& keeps)
{
    return changeEach(
        model,
        [&](Model& anew, std::size_t k) {
            const auto& component = anew.components[k];
            return component.effect->linear() && which(component)
                   && fitByResponse(anew, k, still.gridFor(component)).usable();
        },
        keeps);
}

namespace {

/// Changes shapes of one component after the other, on trial. Whether one of them leaves 0.2 % less; the model then had
/// a quick fit.
/// @param change  of component k; false if there is nothing to change
bool reshapeEach(Model& model, const Record& record, const std::vector<std::size_t>& sections,
                 const FitOptions& options, const Progress& silent,
                 const std::function<bool(Model& anew, std::size_t k)>& change)
{
    constexpr double worthIt = 0.998;
    double now = std::numeric_limits<double>::infinity();
    return changeEach(
        model,
        [&](Model& anew, std::size_t k) {
            const bool any = change(anew, k);
            if (any && std::isinf(now))
                now = quickCost(model, record, sections, options);
            return any;
        },
        [&](Model& anew) {
            return quickFit(anew, record, sections, options, silent).usable()
                   && falls(now, quickCost(anew, record, sections, options), worthIt);
        });
}

}  // namespace

bool wakeShapes(Model& model, const Record& record, const std::vector<std::size_t>& sections, const FitOptions& options,
                const Progress& progress)
{
    return reshapeEach(model, record, sections, options, progress.silent(),
                       [](Model& anew, std::size_t k) { return wakeShapesOf(anew.components[k]); });
}

bool findUsualShapes(Model& model, const Record& record, const std::vector<std::size_t>& sections,
                     const FitOptions& options, const Progress& progress)
{
    const auto isUnusual = [](const Component& component) { return isAtWork(component) && hasUnusualShape(component); };
    if (!hasPeriods(record) || std::none_of(model.components.begin(), model.components.end(), isUnusual))
        return false;
    // The other shape is to win by itself, not by the steps that it gets.
    if (auto fitted = model;
        quickFit(fitted, record, sections, options, progress.silent()).usable()
        && quickCost(fitted, record, sections, options) < quickCost(model, record, sections, options))
        model = std::move(fitted);
    return reshapeEach(model, record, sections, options, progress.silent(), [&](Model& anew, std::size_t k) {
        const auto& component = anew.components[k];
        if (!isUnusual(component))
            return false;
        const LinearResponses still(withoutLaws(anew, record, options.threads));
        return fitUsualShape(anew, k, still.gridFor(component)).usable();
    });
}

bool findPartsAnew(Model& model, const Record& record, const std::vector<std::size_t>& sections,
                   const FitOptions& options, const Progress& progress)
{
    if (!hasPeriods(record))
        return false;
    // What is really there shows at once: the responses have told its shape.
    constexpr double worthIt = 0.95;
    auto glance = options;
    glance.search = {3, 1e-2};
    const bool woken = wakeShapes(model, record, sections, options, progress);
    double now = quickCost(model, record, sections, options);
    return findAnew(
               model, LinearResponses(withoutLaws(model, record, options.threads)),
               [](const Component& component) { return !component.effect->parts(component.operatingRange).empty(); },
               [&](Model& anew) {
                   if (!quickFit(anew, record, sections, glance, progress.silent()).usable()
                       || quickCost(anew, record, sections, options) > now
                       || !quickFit(anew, record, sections, options, progress.silent()).usable())
                       return false;
                   return falls(now, quickCost(anew, record, sections, options), worthIt);
               })
           || woken;
}

}  // namespace excursion
