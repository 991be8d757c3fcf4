// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Grow.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace excursion {
namespace {

/// The effects that stand alone in the vote, as beside what they leave it tells more of the others; where there are
/// none, all that it backs.
std::vector<const Score*> backed(const std::vector<Score>& scores, const std::set<std::string>& without)
{
    std::vector<const Score*> alone, all;
    for (const auto& s : scores) {
        if (without.contains(s.effect->id()))
            continue;
        if (s.vote.standsAlone())
            alone.push_back(&s);
        if (s.vote.backs())
            all.push_back(&s);
    }
    return alone.empty() ? all : alone;
}

/// All effects that a vote may have spoken against in error. Those that are made of resonances show in lines where
/// nothing else does.
std::vector<const Score*> possible(const std::vector<Score>& scores, const std::set<std::string>& without)
{
    std::vector<const Score*> all;
    for (const auto& s : scores) {
        const auto& component = s.model.components.back();
        if (!without.contains(s.effect->id()) && s.effect->parts(component.operatingRange).empty())
            all.push_back(&s);
    }
    return all;
}

/// The linear effects that are tried with these: all, if the vote backs one of them, or one that stood for something
/// else. Many of them can stand in for another, so that a vote on all together backs none, or a wrong one.
std::vector<const Effect*> linearBeside(const std::vector<const Score*>& trial, const std::vector<Score>& scores,
                                        const std::set<std::string>& without)
{
    const bool any = std::any_of(scores.begin(), scores.end(),
                                 [](const Score& s) { return s.effect->linear() && s.vote.backs(); });
    std::vector<const Effect*> linear;
    for (const auto& s : scores)
        if (s.effect->linear() && !without.contains(s.effect->id())
            && (any || std::find(trial.begin(), trial.end(), &s) != trial.end()))
            linear.push_back(s.effect);
    return linear;
}

/// The model with these effects. Laws are at no strength, and so are linear effects where the responses show none.
Model withAll(const std::vector<const Score*>& trial, const std::vector<const Effect*>& linear, const Model& model,
              const WholeSearch& search, const Progress& progress)
{
    Model fuller = linear.empty() ? model : search.withLinear(linear, model, progress);
    const bool found = fuller.components.size() > model.components.size();
    for (const auto* s : trial)
        if (!fuller.has(s->effect->id()) && !(found && s->effect->linear()))
            fuller = withComponent(std::move(fuller), scaled(s->model.components.back(), 0.0));
    return fuller;
}

/// The effects that one model has and another has not.
std::set<std::string> added(const Model& model, const Model& before)
{
    std::set<std::string> ids;
    for (const auto& id : model.effectIds())
        if (!before.has(id))
            ids.insert(id);
    return ids;
}

Model withoutThoseAtRest(Model model, const Model& base)
{
    for (const auto& id : added(model, base))
        if (!isAtWork(*model.find(id)))
            model = withoutEffect(model, id);
    return model;
}

/// Whether a search has been there: what follows would be the same.
bool leadsBy(const Waypoints& path, const Waypoint& place)
{
    constexpr double same = 1e-3;
    return std::any_of(path.begin(), path.end(), [&](const Waypoint& one) {
        return one.effects == place.effects
               && std::abs(one.chiSquaredPerValue - place.chiSquaredPerValue) < same * place.chiSquaredPerValue;
    });
}

/// Puts effects into a whole by rounds of voting. Whether it came to where no other search has been.
/// @param known  of another search
bool grow(Grown& whole, const Model& base, const Record& record, WholeSearch& search, const Waypoints& known,
          const Progress& progress)
{
    constexpr int rounds = 12;
    constexpr double worthARound = 1.0;  // dB
    search.chooseResiduals(whole.model);
    auto now = search.left(whole.model);
    std::vector<Score> scores;  // of the whole, once it was asked
    // What stood for something else in the last round, or brought nothing: others come first in this one.
    std::set<std::string> strange;
    for (int n = 0; n < rounds && !now.isNoise(); ++n) {
        const auto part = progress.part(static_cast<double>(n) / rounds, (n + 1.0) / rounds);
        if (scores.empty()) {
            if (n > 0) {  // laws of too low a degree hide what is small, and make others seem needed
                search.raiseDegrees(whole.model);
                now = search.left(whole.model);
            }
            scores = score(whole.model, record, search.test(), part.part(0.0, 0.4)).scores;
        }
        auto trial = backed(scores, strange);
        if (trial.empty() && record.noiseKnown && now.chiSquaredPerValue < nearNoise)
            trial = possible(scores, strange);
        const auto linear = linearBeside(trial, scores, strange);
        if (trial.empty() && linear.empty())
            break;
        auto fuller = withAll(trial, linear, whole.model, search, part);
        const auto tries = added(fuller, whole.model);
        if (tries.empty())
            break;
        const auto summary = search.fit(fuller, part.part(0.4, 0.8));
        if (!summary.usable())
            break;
        fuller = withoutThoseAtRest(std::move(fuller), base);
        const auto before = std::exchange(strange, search.takeOutImplausible(fuller));
        search.chooseResiduals(fuller);
        now = search.left(whole.model);
        auto then = search.left(fuller);
        if (!then.isNoise()) {  // else there is nothing more to find, and what is not needed goes before the refinement
            search.findPartsAnew(fuller);
            then = search.left(fuller);
            // What goes hardly makes it leave less, unless it is what makes it run away.
            if (then.channels.empty() || search.lost(now, then) > worthARound) {
                WholeSearch::Removals tried;
                search.takeOut(fuller, false, isNeeded, tried);
                then = search.left(fuller);
            }
        }
        if (!(search.lost(now, then) > worthARound)) {
            if (strange.empty() && before.empty() && !trial.empty() && trial.front()->vote.standsAlone())
                strange = tries;
            if (strange.empty() || strange == before)  // the next round would be this one again
                break;
            continue;
        }
        now = then;
        whole.model = std::move(fuller);
        whole.fit = summary;
        scores.clear();
        const auto ids = whole.model.effectIds();
        whole.path.push_back({{ids.begin(), ids.end()}, now.chiSquaredPerValue});
        if (leadsBy(known, whole.path.back()))
            return false;
    }
    return true;
}

}  // namespace

bool isNeeded(const Removal& removal) { return removal.vote.uniqueDb > hardlyNeeded; }

std::optional<Grown> grown(const Model& base, const Record& record, WholeSearch& search, const Waypoints& known,
                           const Progress& progress)
{
    Grown whole;
    whole.model = base;
    if (!grow(whole, base, record, search, known, progress.part(0.0, 0.7)))
        return std::nullopt;
    if (search.exchangeStandIns(whole.model, progress.part(0.7, 0.8))) {  // beside the right ones others may show
        auto fitted = whole.model;
        if (const auto summary = search.fit(fitted, progress.part(0.8, 0.82)); summary.usable()) {
            whole.model = std::move(fitted);
            whole.fit = summary;
        }
        if (!grow(whole, base, record, search, known, progress.part(0.82, 1.0)))
            return std::nullopt;
    }
    return whole;
}

}  // namespace excursion
