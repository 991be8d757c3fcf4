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

/// The law that alone would clearly leave less than the model and than any other effect; none where that is a linear
/// effect. Derivatives speak against a strong law: what it does at one level is not what it does at another until the
/// model follows it.
const Score* leaderOf(const ScoreResult& asked, const std::set<std::string>& without)
{
    constexpr double clearly = 0.9;
    const auto& first = asked.scores.front();
    const bool leads = !first.effect->linear() && first.chiSquaredPerValue < clearly * asked.chiSquaredPerValue;
    return leads && !without.contains(first.effect->id()) ? &first : nullptr;
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
    return std::any_of(path.begin(), path.end(), [&](const Waypoint& one) { return isNear(one, place, same); });
}

/// A whole that effects are put into.
class Growth {
public:
    Growth(Grown& whole, const Model& base, const Record& record, WholeSearch& search)
        : whole_(whole), base_(base), record_(record), search_(search)
    {
        lookAgain();
    }

    bool isNoise() const { return now_.isNoise(); }
    const Left& now() const { return now_; }
    Waypoint place() const
    {
        const auto ids = whole_.model.effectIds();
        return {{ids.begin(), ids.end()}, now_.chiSquaredPerValue};
    }

    enum class Outcome { grown, again, stuck };

    /// All at once that a vote backs, and the leader; `again` where the next round is to be without some of them.
    Outcome byVote(const Progress&);

    /// From other starts of the laws that it has, where votes lead no further. Whether that leads on.
    bool byOtherStarts(const Progress&);

    /// One law, where votes lead no further and much is left: each is fitted, and of those that take 3 dB off a channel
    /// the one comes in that leaves least. Whether there is one. byOtherStarts() has looked again before.
    bool byTrial(const Progress&);

private:
    void lookAgain()
    {
        search_.chooseResiduals(whole_.model);
        now_ = search_.left(whole_.model);
    }
    /// Near the noise effects that are not there would explain what a model leaves that has not arrived yet.
    void arrive()
    {
        constexpr int most = 3;
        constexpr double worthIt = 0.95;
        for (int n = 0; n < most && record_.noiseKnown && now_.chiSquaredPerValue < nearNoise && !isNoise(); ++n) {
            auto further = whole_.model;
            const auto fit = search_.fit(further);
            if (!fit.usable())
                return;
            const auto then = search_.left(further);
            if (then.channels.empty() || then.chiSquaredPerValue > worthIt * now_.chiSquaredPerValue)
                return;
            takeIn(std::move(further), fit);
            now_ = then;
        }
    }
    void takeIn(Model model, const FitSummary& fit)
    {
        whole_.model = std::move(model);
        whole_.fit = fit;
        asked_ = {};
    }

    Grown& whole_;
    const Model& base_;
    const Record& record_;
    WholeSearch& search_;
    Left now_;
    ScoreResult asked_;  // of the whole; empty until it was asked
    bool begun_ = false;
    // What stood for something else in the last round, or brought nothing: others come first in this one.
    std::set<std::string> strange_;
};

constexpr double worthARound = 1.0, barelyShown = 0.25;  // dB

Growth::Outcome Growth::byVote(const Progress& progress)
{
    if (asked_.scores.empty()) {
        if (std::exchange(begun_, true)) {  // laws of too low a degree hide what is small, and make others seem needed
            search_.raiseDegrees(whole_.model);
            now_ = search_.left(whole_.model);
            arrive();
            if (now_.chiSquaredPerValue < nearNoise && !isNoise())
                byOtherStarts(progress.part(0.0, 0.2));
            if (isNoise())
                return Outcome::grown;
        }
        asked_ = score(whole_.model, record_, search_.test(), progress.part(0.2, 0.4));
    }
    if (asked_.scores.empty())
        return Outcome::stuck;
    auto trial = backed(asked_.scores, strange_);
    const bool near = record_.noiseKnown && now_.chiSquaredPerValue < nearNoise;
    const bool unbacked = trial.empty() && near;
    if (unbacked)
        trial = possible(asked_.scores, strange_);
    const auto* leader = trial.empty() || near || !record_.noiseKnown ? nullptr : leaderOf(asked_, strange_);
    if (leader && std::find(trial.begin(), trial.end(), leader) != trial.end())
        leader = nullptr;
    if (leader)
        trial.push_back(leader);
    const auto linear = linearBeside(trial, asked_.scores, strange_);
    if (trial.empty() && linear.empty())
        return Outcome::stuck;
    auto fuller = withAll(trial, linear, whole_.model, search_, progress);
    const auto tries = added(fuller, whole_.model);
    if (tries.empty() || (unbacked && !search_.gainsAtOnce(fuller, now_, barelyShown)))
        return Outcome::stuck;
    const auto withoutLeader = [&] {  // it may have taken those down that the vote backs
        strange_ = {leader->effect->id()};
        return Outcome::again;
    };
    // At the noise no law is strong, and one start is enough.
    const auto part = progress.part(0.4, 0.8);
    const auto summary = near ? search_.fit(fuller, part) : search_.fitFromEachStart(fuller, tries, part);
    if (!summary.usable())
        return leader ? withoutLeader() : Outcome::stuck;
    fuller = withoutThoseAtRest(std::move(fuller), base_);
    const auto before = std::exchange(strange_, search_.takeOutImplausible(fuller));
    search_.chooseResiduals(fuller);
    now_ = search_.left(whole_.model);
    auto then = search_.left(fuller);
    if (!then.isNoise()) {  // else there is nothing more to find, and what is not needed goes before the refinement
        search_.findPartsAnew(fuller);
        then = search_.left(fuller);
        // What goes hardly makes it leave less, unless it is what makes it run away.
        if (then.channels.empty() || search_.lost(now_, then) > worthARound) {
            WholeSearch::Removals tried;
            search_.takeOut(fuller, false, isNeeded, tried);
            then = search_.left(fuller);
        }
    }
    if (search_.lost(now_, then) > worthARound) {
        takeIn(std::move(fuller), summary);
        now_ = then;
        return Outcome::grown;
    }
    if (leader)
        return withoutLeader();
    if (strange_.empty() && before.empty() && !trial.empty() && trial.front()->vote.standsAlone())
        strange_ = tries;
    // else the next round would be this one again
    return strange_.empty() || strange_ == before ? Outcome::stuck : Outcome::again;
}

bool Growth::byOtherStarts(const Progress& progress)
{
    lookAgain();  // what was rejected chose the residuals
    if (!record_.noiseKnown || now_.chiSquaredPerValue < atNoise
        || !search_.beginAt(place(), WholeSearch::Attempt::otherStarts))
        return false;
    auto anew = whole_.model;
    auto summary = whole_.fit;
    if (!search_.startAnew(anew, summary, progress))
        return false;
    strange_ = search_.takeOutImplausible(anew);
    takeIn(std::move(anew), summary);
    lookAgain();
    return true;
}

bool Growth::byTrial(const Progress& progress)
{
    constexpr double convincing = 3.0;  // dB
    if (!record_.noiseKnown || now_.chiSquaredPerValue < nearNoise
        || !search_.beginAt(place(), WholeSearch::Attempt::laws))
        return false;
    auto laws = possible(asked_.scores, {});
    std::erase_if(laws, [](const Score* s) { return s->effect->linear(); });
    std::optional<Model> best;
    FitSummary fit;
    double least = now_.chiSquaredPerValue;
    for (std::size_t n = 0; n < laws.size(); ++n) {
        const auto count = static_cast<double>(laws.size()), done = static_cast<double>(n);
        Model with;
        const auto summary = search_.tryLaw(with, *laws[n],
                                            progress.part(0.9 * done / count, 0.9 * (done + 1.0) / count));
        if (!summary.usable() || !isAtWork(with.components.back()))
            continue;
        const auto then = search_.left(with);
        if (search_.lost(now_, then) > convincing && then.chiSquaredPerValue < least) {
            least = then.chiSquaredPerValue;
            best = std::move(with);
            fit = summary;
        }
    }
    if (!best)
        return false;
    auto further = *best;  // its trial was brief
    if (const auto run = search_.fit(further, progress.part(0.9, 1.0)); run.usable()) {
        best = std::move(further);
        fit = run;
    }
    strange_ = search_.takeOutImplausible(*best);
    takeIn(std::move(*best), fit);
    lookAgain();
    return true;
}

/// Whether moves between sections explain what a model left better than the effects that have come in since. They may
/// be in a wrong shape yet.
bool explainsMore(const Left& bySections, const Left& byEffects)
{
    constexpr double near = 1.5, clearly = 1.5;
    if (bySections.channels.empty() || bySections.chiSquaredPerValue > near * atNoise)
        return false;
    const auto excess = [](const Left& left) { return std::max(left.chiSquaredPerValue - sureNoise, 1.0 - sureNoise); };
    return excess(byEffects) > clearly * excess(bySections);
}

/// Puts effects into a whole. Whether it came to where no other search has been.
/// @param known  of another search
bool grow(Grown& whole, const Model& base, const Record& record, WholeSearch& search, const Waypoints& known,
          const Progress& progress)
{
    constexpr int rounds = 12;
    Growth growth(whole, base, record, search);
    for (int n = 0; n < rounds && !growth.isNoise(); ++n) {
        const auto part = progress.part(static_cast<double>(n) / rounds, (n + 1.0) / rounds);
        const auto before = whole;
        const auto bySections = search.leftOfSections(whole.model);
        const auto outcome = growth.byVote(part.part(0.0, 0.8));
        if (outcome == Growth::Outcome::again)
            continue;
        if (explainsMore(bySections, growth.now())) {
            whole = before;
            whole.sectionsDrift = true;
            break;
        }
        if (outcome == Growth::Outcome::stuck && !growth.byOtherStarts(part.part(0.8, 0.9))
            && !growth.byTrial(part.part(0.9, 1.0)))
            break;
        whole.path.push_back(growth.place());
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
    if (whole.sectionsDrift)
        return whole;
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
