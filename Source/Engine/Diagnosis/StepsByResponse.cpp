// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/StepsByResponse.h"

#include "Engine/Driver/Catalogue.h"
#include "Engine/Driver/FitResponse.h"
#include "Engine/Driver/Parallel.h"
#include "Engine/Driver/Seen.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace excursion {
namespace {

constexpr double neededDb = 1.0;   // what an effect must take off the error to pay for its parameters, as no noise is known
constexpr LeastSquaresOptions thoroughly {80, 1e-8};

/// A model and the mean over its responses of their relative error power.
struct Found {
    Model model;
    double power = std::numeric_limits<double>::infinity();
};

double powerLeft(const Model& model, const std::vector<ResponseTarget>& targets)
{
    double sum = 0.0;
    for (const auto& target : targets)
        sum += std::pow(10.0, responseErrorDb(model, target) / 10.0);
    return sum / static_cast<double>(targets.size());
}

/// The model with one more effect; of infinite power where that cannot be fitted.
Found withOneMore(const Model& model, const Effect& effect, const std::vector<ResponseTarget>& targets)
{
    Found found {model};
    if (!addByResponse(found.model, effect, targets).usable)
        return found;
    found.power = powerLeft(found.model, targets);
    auto refined = found.model;
    if (refineByResponse(refined, targets).usable)
        if (const double power = powerLeft(refined, targets); power < found.power)
            found = {std::move(refined), power};
    return found;
}

/// The models with one more effect than these, the best of each set of effects; lowest error first.
std::vector<Found> oneMore(const std::vector<Found>& models, const std::vector<const Effect*>& effects, const std::vector<ResponseTarget>& targets,
                           unsigned threads, const Progress& progress)
{
    std::vector<std::pair<const Model*, const Effect*>> trials;
    for (const auto& found : models)
        for (const auto* effect : effects)
            if (!found.model.has(effect->id()))
                trials.emplace_back(&found.model, effect);
    std::vector<Found> results(trials.size());
    inParallel(trials.size(), threads, progress, [&](std::size_t n) {
        results[n] = withOneMore(*trials[n].first, *trials[n].second, targets);
        return true;
    });
    std::erase_if(results, [](const Found& result) { return !std::isfinite(result.power); });
    std::stable_sort(results.begin(), results.end(), [](const Found& a, const Found& b) { return a.power < b.power; });
    std::set<std::set<std::string>> taken;
    std::vector<Found> best;
    for (auto& result : results) {
        const auto ids = result.model.effectIds();
        if (taken.insert({ids.begin(), ids.end()}).second)
            best.push_back(std::move(result));
    }
    return best;
}

/// The model with as many effects as the responses show together, however little the last of them bring.
Found withAll(const Model& base, const std::vector<const Effect*>& effects, const std::vector<ResponseTarget>& targets, unsigned threads,
              const Progress& progress)
{
    constexpr std::size_t kept = 2;   // sets of one size
    std::vector<Found> level {{base, powerLeft(base, targets)}};
    Found best = level.front();
    for (std::size_t n = 0; n < effects.size(); ++n) {
        const auto count = static_cast<double>(effects.size()), done = static_cast<double>(n);
        progress.at(done / count, "searching for effects together");
        level = oneMore(level, effects, targets, threads, progress.part(done / count, (done + 1.0) / count));
        if (level.empty())
            break;
        level.resize(std::min(level.size(), kept));
        if (level.front().power < best.power)
            best = level.front();
    }
    return best;
}

/// A model without one of its effects, fitted again.
struct Leaner {
    std::string without;
    Found found;
    double lostDb = 0.0;
    bool seen = true;   ///< the model that has it is sure of it
};

/// Without each of the effects that the base does not have; what is missed least first.
std::vector<Leaner> withoutEach(const Model& base, const Found& whole, const std::vector<ResponseTarget>& targets)
{
    std::vector<Leaner> each;
    for (std::size_t k = 1; k < whole.model.components.size(); ++k) {
        const auto id = whole.model.components[k].effect->id();
        if (base.has(id))
            continue;
        Leaner leaner {id, {withoutEffect(whole.model, id)}, 0.0, isSeen(whole.model, k)};
        if (!fitResponse(leaner.found.model, targets, thoroughly).usable)
            continue;
        leaner.found.power = powerLeft(leaner.found.model, targets);
        leaner.lostDb = 10.0 * std::log10(leaner.found.power / whole.power);
        each.push_back(std::move(leaner));
    }
    std::stable_sort(each.begin(), each.end(), [](const Leaner& a, const Leaner& b) { return a.lostDb < b.lostDb; });
    return each;
}

/// Takes out what the others can do without, and what stands for something else.
void takeOut(const Model& base, Found& whole, const std::vector<ResponseTarget>& targets)
{
    for (;;) {
        auto each = withoutEach(base, whole, targets);
        auto goes = std::find_if(each.begin(), each.end(), [](const Leaner& leaner) { return !leaner.seen; });
        if (goes == each.end())
            goes = each.begin();
        if (goes == each.end() || (goes->seen && goes->lostDb >= neededDb))
            return;
        whole = std::move(goes->found);
    }
}

} // namespace

std::vector<Step> stepsByResponse(const Model& base, const Spectra& spectra, unsigned threads, const Progress& progress)
{
    constexpr int coarse = 16;   // points an octave: enough to tell what is there
    const auto targets = responsesOf(spectra);
    std::vector<const Effect*> effects;
    for (const auto* effect : catalogue())
        if (!base.has(effect->id()) && whyUnseen(*effect, seenIn(spectra)).empty())
            effects.push_back(effect);
    auto whole = withAll(base, effects, thinned(targets, coarse), threads, progress.part(0.0, 0.7));
    const auto settle = [&] {
        refineByResponse(whole.model, targets);
        whole.power = powerLeft(whole.model, targets);
    };
    progress.at(0.7, "taking out what is not needed");
    settle();
    takeOut(base, whole, targets);
    progress.at(0.9, "putting the effects in order");
    settle();
    std::vector<Step> steps;
    for (auto rest = std::move(whole);;) {
        auto each = withoutEach(base, rest, targets);
        if (each.empty())
            break;
        auto& least = each.front();
        steps.push_back({least.without, std::move(rest.model), {least.lostDb, 0.0}});
        rest = std::move(least.found);
    }
    std::reverse(steps.begin(), steps.end());
    return steps;
}

} // namespace excursion
