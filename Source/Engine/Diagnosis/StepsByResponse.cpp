// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/StepsByResponse.h"

#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FitResponse.h"
#include "Engine/Loudspeaker/Seen.h"
#include "Engine/Numerics/Parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace excursion {
namespace {

// what an effect must take off the error to pay for its parameters, as no noise is known
constexpr double neededDb = 1.0;
constexpr LeastSquaresOptions thoroughly {80, 1e-8};

struct Found {
    Model model;
    double errorDb = std::numeric_limits<double>::infinity();  ///< mean over the responses
};
/// The best that was found with each set of effects.
using Sets = std::map<std::set<std::string>, Found>;

std::set<std::string> setOf(const Model& model)
{
    const auto ids = model.effectIds();
    return {ids.begin(), ids.end()};
}

/// The number of effects that stand for something else.
std::size_t strangersIn(const Model& model)
{
    std::size_t count = 0;
    for (std::size_t k = 1; k < model.components.size(); ++k)
        count += isItself(model, k) ? 0 : 1;
    return count;
}

/// The model with one more effect; of infinite error where that cannot be fitted. What has become itself in it may have
/// cost a little (refineByResponse()).
Found withOneMore(const Model& model, const Effect& effect, const std::vector<ResponseTarget>& targets)
{
    Found found {model};
    if (!addByResponse(found.model, effect, targets).usable())
        return found;
    found.errorDb = responseErrorDb(found.model, targets);
    auto refined = found.model;
    if (refineByResponse(refined, targets).usable())
        if (const double errorDb = responseErrorDb(refined, targets);
            errorDb < found.errorDb
            || (errorDb < found.errorDb + neededDb && strangersIn(refined) < strangersIn(found.model)))
            found = {std::move(refined), errorDb};
    return found;
}

/// The models with one more effect than these, the best of each set of effects; lowest error first.
std::vector<Found> oneMore(const std::vector<Found>& models, const std::vector<const Effect*>& effects,
                           const std::vector<ResponseTarget>& targets, unsigned threads, const Progress& progress)
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
    std::erase_if(results, [](const Found& result) { return !std::isfinite(result.errorDb); });
    std::stable_sort(results.begin(), results.end(),
                     [](const Found& a, const Found& b) { return a.errorDb < b.errorDb; });
    std::set<std::set<std::string>> taken;
    std::erase_if(results, [&](const Found& result) { return !taken.insert(setOf(result.model)).second; });
    return results;
}

/// Whether every effect that the base does not have is itself: none has been bent to stand for something else.
bool areThemselves(const Model& model, const Model& base)
{
    for (std::size_t k = 1; k < model.components.size(); ++k)
        if (!base.has(model.components[k].effect->id()) && !isItself(model, k))
            return false;
    return true;
}

struct FoundTogether {
    Found best;            ///< lowest error
    Found bestThemselves;  ///< lowest error of those whose effects are themselves
};

/// The model with as many effects as the responses show together, however little the last of them bring. What is bent
/// to stand for something else may become itself when that is in, or may hide it: of the sets of one size the best goes
/// on, and the best without such effects.
/// @param sets  gets all that is found on the way
FoundTogether withAll(const Model& base, const std::vector<const Effect*>& effects,
                      const std::vector<ResponseTarget>& targets, unsigned threads, Sets& sets,
                      const Progress& progress)
{
    constexpr std::size_t kept = 2;  // sets of one size
    std::vector<Found> level {{base, responseErrorDb(base, targets)}};
    FoundTogether found {level.front(), level.front()};
    const auto keepBetter = [](Found& best, const Found& other) {
        if (other.errorDb < best.errorDb)
            best = other;
    };
    for (std::size_t n = 0; n < effects.size(); ++n) {
        const auto count = static_cast<double>(effects.size()), done = static_cast<double>(n);
        progress.at(done / count, "searching for effects together");
        level = oneMore(level, effects, targets, threads, progress.part(done / count, (done + 1.0) / count));
        if (level.empty())
            break;
        for (const auto& one : level)
            sets.emplace(setOf(one.model), one);
        keepBetter(found.best, level.front());
        const auto themselves = std::find_if(level.begin(), level.end(),
                                             [&](const Found& one) { return areThemselves(one.model, base); });
        if (themselves != level.end()) {
            keepBetter(found.bestThemselves, *themselves);
            if (themselves != level.begin())
                std::rotate(level.begin() + 1, themselves, themselves + 1);
        }
        level.resize(std::min(level.size(), kept));
    }
    return found;
}

/// A model without one of its effects, fitted again.
struct Leaner {
    std::string without;
    Found found;
    double lostDb = 0.0;
    bool itself = true;  ///< in the model that has it
};

/// What a search keeps at hand.
struct ResponseSearch {
    const Model& base;
    const std::vector<ResponseTarget>& targets;
    Sets sets;
    unsigned threads;
};

/// Without each of the effects that the base does not have; what is missed least first. What is left is fitted from
/// where it is, and from the best that was found without the effect before: one that carries much of the stiffness or
/// the mass leaves the others far from where they would be.
std::vector<Leaner> withoutEach(const Found& whole, const ResponseSearch& search, const Progress& progress)
{
    std::vector<Leaner> each;
    std::vector<std::pair<std::size_t, Model>> starts;  // of which Leaner
    for (std::size_t k = 1; k < whole.model.components.size(); ++k) {
        const auto id = whole.model.components[k].effect->id();
        if (search.base.has(id))
            continue;
        auto rest = withoutEffect(whole.model, id);
        if (const auto before = search.sets.find(setOf(rest)); before != search.sets.end())
            starts.emplace_back(each.size(), before->second.model);
        starts.emplace_back(each.size(), std::move(rest));
        Leaner leaner;
        leaner.without = id;
        leaner.itself = isItself(whole.model, k);
        each.push_back(std::move(leaner));
    }
    std::vector<Found> fits(starts.size());
    inParallel(starts.size(), search.threads, progress, [&](std::size_t n) {
        auto& model = starts[n].second;
        if (fitResponse(model, search.targets, thoroughly).usable()) {
            fits[n].errorDb = responseErrorDb(model, search.targets);
            fits[n].model = std::move(model);
        }
        return true;
    });
    for (std::size_t n = 0; n < fits.size(); ++n)
        if (auto& leaner = each[starts[n].first]; fits[n].errorDb < leaner.found.errorDb)
            leaner.found = std::move(fits[n]);
    std::erase_if(each, [](const Leaner& leaner) { return !std::isfinite(leaner.found.errorDb); });
    for (auto& leaner : each)
        leaner.lostDb = leaner.found.errorDb - whole.errorDb;
    std::stable_sort(each.begin(), each.end(), [](const Leaner& a, const Leaner& b) { return a.lostDb < b.lostDb; });
    return each;
}

/// Takes out what the others can do without, and then what stands for something else, which may be due to what was not
/// needed.
void takeOut(Found& whole, const ResponseSearch& search, const Progress& progress)
{
    for (;;) {
        auto each = withoutEach(whole, search, progress);
        auto goes = each.begin();
        if (goes != each.end() && goes->lostDb >= neededDb)
            goes = std::find_if(each.begin(), each.end(), [](const Leaner& leaner) { return !leaner.itself; });
        if (goes == each.end())
            return;
        whole = std::move(goes->found);
    }
}

}  // namespace

std::vector<Step> stepsByResponse(const Model& base, const Spectra& spectra, unsigned threads, const Progress& progress)
{
    constexpr int coarse = 16;  // points an octave: enough to tell what is there
    const auto targets = responsesOf(spectra);
    std::vector<const Effect*> effects;
    for (const auto* effect : catalogue())
        if (!base.has(effect->id()) && whyUnseen(*effect, seenIn(spectra)).empty())
            effects.push_back(effect);
    ResponseSearch search {base, targets, {}, threads};
    const auto found = withAll(base, effects, thinned(targets, coarse), threads, search.sets, progress.part(0.0, 0.7));
    const auto settle = [&](Found& one) {
        refineByResponse(one.model, targets);
        one.errorDb = responseErrorDb(one.model, targets);
    };
    const auto needed = [&](Found one) {
        settle(one);
        takeOut(one, search, progress);
        return one;
    };
    progress.at(0.7, "taking out what is not needed");
    auto whole = needed(found.best);
    if (setOf(found.bestThemselves.model) != setOf(found.best.model))
        if (auto other = needed(found.bestThemselves); other.errorDb < whole.errorDb)
            whole = std::move(other);
    progress.at(0.9, "putting the effects in order");
    settle(whole);
    std::vector<Step> steps;
    for (auto rest = std::move(whole);;) {
        auto each = withoutEach(rest, search, progress);
        if (each.empty())
            break;
        auto& least = each.front();
        steps.push_back({least.without, std::move(rest.model), {least.lostDb, 0.0}});
        rest = std::move(least.found);
    }
    std::reverse(steps.begin(), steps.end());
    return steps;
}

}  // namespace excursion
