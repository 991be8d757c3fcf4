// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/WholeSearch.h"

#include "Engine/Diagnosis/FindAnew.h"
#include "Engine/Diagnosis/FollowSections.h"
#include "Engine/Diagnosis/LawDegrees.h"
#include "Engine/Diagnosis/QuickFit.h"
#include "Engine/Diagnosis/SectionMoves.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FeedbackError.h"

#include <cmath>

namespace excursion {
namespace {

constexpr double sorelyMissed = 15.0;  // dB more that are left: no fit would make that good

double inDecibels(double ratio) { return 10.0 * std::log10(ratio); }

}  // namespace

bool mayStandIn(const Model& model, const std::string& effect)
{
    const auto& component = *model.find(effect);
    return component.effect->linear() && component.effect->felt()
           && !component.effect->parts(component.operatingRange).empty();
}

WholeSearch::WholeSearch(const Model& base, const Record& record, const FitOptions& options, const Progress& progress)
    : base_(base), record_(record), sections_(trialSections(record, 2)), options_(options), silent_(progress.silent())
{
    test_.threads = options.threads;
}

void WholeSearch::chooseResiduals(const Model& model)
{
    options_.substeps = 0;  // chosen for this model
    excursion::chooseResiduals(options_, test_, model, record_, sections_);
}

FitOptions WholeSearch::within(const LeastSquaresOptions& steps) const
{
    auto options = options_;
    options.search = steps;
    return options;
}

FitSummary WholeSearch::fit(Model& model, const Progress& progress) const { return fit(model, full, progress); }

bool WholeSearch::gainsAtOnce(Model model, const Left& before, double dB) const
{
    return fit(model, {2, 1e-3}).usable() && lost(before, left(model)) > dB;  // a shape moves once its law is at work
}

/// With laws that are fed alone, as they are quick.
FitSummary WholeSearch::glanceAt(Model& model) const
{
    auto options = within(glance);
    options.fedGradient = false;
    return quickFit(model, record_, sections_, options, silent_);
}

FitSummary WholeSearch::fit(Model& model, const LeastSquaresOptions& steps, const Progress& progress) const
{
    return quickFit(model, record_, sections_, within(steps), progress);
}

/// Of models that are played anyhow: with the simulation's own slopes.
FitSummary WholeSearch::fitExactly(Model& model) const
{
    auto options = within(brief);
    options.fedGradient = false;
    return excursion::fit(model, record_, sections_, options, silent_);
}

void WholeSearch::findPartsAnew(Model& model) const
{
    excursion::findPartsAnew(model, record_, sections_, within(brief), silent_);
}

void WholeSearch::raiseDegrees(Model& model) const
{
    constexpr double hides = 0.005;  // what lowers the cost by less hides no effect
    raiseAsItPays(model, record_, sections_, within(brief), test_, hides, silent_);
}

Left WholeSearch::left(const Model& model) const { return left(model, test_.played); }

Left WholeSearch::left(const Model& model, bool played) const
{
    auto plain = test_.run();
    plain.gradient = false;
    plain.played = played;
    return leftBy(quickError(model, record_, sections_, {}, plain, silent_));
}

Left WholeSearch::leftOfSections(const Model& model) const
{
    if (!tellsMoves(record_))
        return {};
    auto followed = test_.run();
    followed.gradient = false;
    followed.sectionsDrift = true;
    constexpr double most = 0.75;  // of what the model leaves
    const auto glimpse = leftBy(quickError(model, record_, sections_, {}, followed, silent_));
    if (glimpse.channels.empty()
        || glimpse.chiSquaredPerValue - sureNoise > most * (left(model).chiSquaredPerValue - sureNoise))
        return {};
    auto fitted = model;
    auto options = within(brief);
    options.sectionsDrift = true;
    if (!quickFit(fitted, record_, sections_, options, silent_).usable())
        return {};
    const auto fits = quickError(fitted, record_, sections_, {}, followed, silent_);
    return movesOf(fits).areSmall() ? leftBy(fits) : Left {};
}

Left WholeSearch::leftBy(const std::vector<SectionFit>& fits) const
{
    const auto sum = sumOf(fits);
    Left left;
    if (!sum)
        return left;
    left.cost = sum->cost;
    left.chiSquaredPerValue = sum->cost / std::max(1.0, sum->rows);
    for (std::size_t c = 0; c < record_.channels.size(); ++c) {
        double cost = 0.0, rows = 0.0;
        ErrorPower power;
        for (const auto& fit : fits) {
            cost += fit.channels[c].cost;
            rows += fit.channels[c].rows;
            power.add(fit.power[c]);
        }
        left.channels.push_back({cost / std::max(1.0, rows),
                                 record_.noiseKnown ? power.overNoise() : std::numeric_limits<double>::infinity()});
    }
    return left;
}

double WholeSearch::lost(const Left& more, const Left& less) const
{
    constexpr double beyondMeasure = std::numeric_limits<double>::infinity();
    if (more.channels.empty() || less.channels.empty())
        return more.channels.empty() == less.channels.empty() ? 0.0
               : more.channels.empty()                        ? beyondMeasure
                                                              : -beyondMeasure;
    double most = -beyondMeasure;
    for (std::size_t c = 0; c < less.channels.size(); ++c) {
        const auto &then = more.channels[c], &now = less.channels[c];
        const double sure = record_.noiseKnown && !now.isNoise() ? sureNoise : 0.0;
        const double least = record_.noiseKnown ? 0.5 * (1.0 - sure) : 0.0;
        most = std::max(most, inDecibels(std::max(then.chiSquaredPerValue - sure, least)
                                         / std::max({now.chiSquaredPerValue - sure, least, 1e-300})));
        if (record_.noiseKnown)
            most = std::max(most, inDecibels(std::max(then.power, 1.0) / std::max(now.power, 1.0)));
    }
    return most;
}

/// The vote on an effect that was really taken out. At the noise what it explains is what is left more without it, not
/// the little that derivatives say of that; while more is missing the doubt of these stands.
Vote WholeSearch::votedBy(const std::string& effect, const Vote& vote, const Left& without, const Left& with,
                          bool atNoise) const
{
    const double explained = std::max(without.cost - with.cost, 1e-300);
    return {lost(without, with),
            effectNamed(effect).linear()                 ? 0.0
            : atNoise && !std::isnan(vote.inconsistency) ? vote.byLevel / explained
                                                         : vote.inconsistency,
            vote.byLevel};
}

/// @param still  responses of the record without the model's laws, once they were needed
Removal WholeSearch::without(const Model& model, const Asked& now, const std::string& effect, const Vote& vote,
                             bool thorough, std::optional<LinearResponses>& still) const
{
    Removal removal {vote, {}};
    auto leaner = withoutEffect(model, effect);
    auto seen = leaner;
    if (!glanceAt(seen).usable())
        return removal;
    auto then = left(seen, false);
    // What is found at the noise is believed later on, so there a glance is not enough.
    const bool thoroughly = thorough || test_.played || now.chosen.isNoise();
    const bool suspect = thorough && mayStandIn(model, effect);
    const bool told = !suspect && !(lost(then, now.fed) < (thoroughly ? sorelyMissed : barelyMissed));
    if (told || left(seen).cost < left(leaner).cost)
        leaner = std::move(seen);
    if (!told) {
        if (!fit(leaner, brief).usable())
            return removal;
        then = left(leaner);
        if (suspect || (effectNamed(effect).linear() && lost(then, now.chosen) < barelyMissed)) {
            if (!still)
                still.emplace(withoutLaws(model, record_, options_.threads));
            if (reshape(leaner, then, now.chosen, *still))
                then = left(leaner);
        }
        const double missed = lost(then, now.chosen);
        if (thorough && test_.played && missed > hardlyNeeded && missed < barelyMissed && fitExactly(leaner).usable())
            then = left(leaner);
    }
    const auto& with = told ? now.fed : now.chosen;
    removal.vote = votedBy(effect, vote, then, with, now.chosen.areNoise());
    removal.times = then.chiSquaredPerValue / with.chiSquaredPerValue;
    removal.staysNoise = then.areNoise();
    removal.leaner = std::move(leaner);
    return removal;
}

WholeSearch::Removals WholeSearch::tryWithout(const Model& model, bool thorough, const Removals& before) const
{
    Removals tried;
    const auto chosen = left(model);
    const Asked now {chosen, test_.played ? left(model, false) : chosen};
    const auto strange = implausibleIn(model);
    std::optional<LinearResponses> still;
    for (const auto& [effect, vote] : votesOf(model, record_, test_)) {
        if (base_.has(effect))
            continue;
        const auto known = before.find(effect);
        const bool plausible = !strange.contains(effect);
        auto& one = tried[effect];
        one = thorough && mayStandIn(model, effect) ? without(model, now, effect, vote, thorough, still)
              : vote.standsAlone() && plausible     ? Removal {vote, {}}
              : known != before.end() && known->second.vote.uniqueDb > barelyMissed
                  ? Removal {known->second.vote, {}}
                  : without(model, now, effect, vote, thorough, still);
        one.plausible = plausible;
        one.suspect = mayStandIn(model, effect);
    }
    return tried;
}

bool WholeSearch::takeOut(Model& model, bool thorough, const std::function<bool(const Removal&)>& keeps,
                          Removals& tried) const
{
    bool any = false;
    tried = tryWithout(model, thorough, tried);
    std::vector<std::pair<const std::string, Removal>*> order;
    for (auto& one : tried)
        order.push_back(&one);
    std::stable_sort(order.begin(), order.end(),
                     [](auto* a, auto* b) { return a->second.vote.uniqueDb < b->second.vote.uniqueDb; });
    for (auto* one : order) {
        auto& [effect, removal] = *one;
        if (keeps(removal))
            continue;
        const bool fitted = !any && !removal.leaner.components.empty();
        auto leaner = fitted ? std::move(removal.leaner) : withoutEffect(model, effect);
        if (!fitted) {  // also when another one has gone, whose work it may do now
            if (!fit(leaner, brief).usable() || (thorough && test_.played && !fitExactly(leaner).usable()))
                continue;
            const auto then = left(leaner), now = left(model);
            if (keeps({.vote = votedBy(effect, removal.vote, then, now, now.areNoise()),
                       .leaner = {},
                       .times = then.chiSquaredPerValue / now.chiSquaredPerValue,
                       .staysNoise = then.areNoise(),
                       .plausible = !implausibleIn(model).contains(effect),
                       .suspect = removal.suspect}))
                continue;
        }
        model = std::move(leaner);
        any = true;
    }
    return any;
}

/// What seems to miss a linear effect a little may only have another of its linear effects in a wrong shape, from which
/// no small step leads to the right one: each is found anew on the responses. Whether that helped.
bool WholeSearch::reshape(Model& model, const Left& now, const Left& enough, const LinearResponses& still) const
{
    auto best = now;
    return findAnew(
        model, still,
        [&](const Component& component) {
            return !base_.has(component.effect->id()) && lost(best, enough) > hardlyNeeded;
        },
        [&](Model& anew) {
            if (!fit(anew, brief).usable())
                return false;
            auto then = left(anew);
            const bool helps = lost(best, then) > hardlyNeeded && then.chiSquaredPerValue < best.chiSquaredPerValue;
            if (helps)
                best = std::move(then);
            return helps;
        });
}

}  // namespace excursion
