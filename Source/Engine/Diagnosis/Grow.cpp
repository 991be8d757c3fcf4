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

/// Beside what a vote backs, the law that alone would leave less than any other effect. Derivatives speak against a
/// strong law: what it does at one level is not what it does at another until the model follows it.
void takeLeaderIn(std::vector<const Score*>& trial, const std::vector<Score>& scores,
                  const std::set<std::string>& without)
{
    const auto& leader = scores.front();
    if (!leader.effect->linear() && !without.contains(leader.effect->id())
        && std::find(trial.begin(), trial.end(), &leader) == trial.end())
        trial.push_back(&leader);
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

/// A whole that effects are put into.
class Growth {
public:
    Growth(Grown& whole, const Model& base, const Record& record, WholeSearch& search)
        : whole_(whole), base_(base), record_(record), search_(search)
    {
        search_.chooseResiduals(whole_.model);
        now_ = search_.left(whole_.model);
    }

    bool isNoise() const { return now_.isNoise(); }
    Waypoint place() const
    {
        const auto ids = whole_.model.effectIds();
        return {{ids.begin(), ids.end()}, now_.chiSquaredPerValue};
    }

    enum class Outcome { grown, again, stuck };

    /// All at once that a vote backs; `again` where the next vote is to be without what stood for something else.
    Outcome byVote(const Progress&);

    /// One law, where votes lead no further and much is left: each is fitted, and the one that leaves least comes in.
    /// Whether there is one.
    bool byTrial(const Progress&);

private:
    void takeIn(Model model, const FitSummary& fit, const Left& left)
    {
        whole_.model = std::move(model);
        whole_.fit = fit;
        now_ = left;
        scores_.clear();
    }

    Grown& whole_;
    const Model& base_;
    const Record& record_;
    WholeSearch& search_;
    Left now_;
    std::vector<Score> scores_;  // of the whole, once it was asked
    bool begun_ = false;
    // What stood for something else in the last round, or brought nothing: others come first in this one.
    std::set<std::string> strange_;
};

constexpr double worthARound = 1.0;  // dB

Growth::Outcome Growth::byVote(const Progress& progress)
{
    if (scores_.empty()) {
        if (std::exchange(begun_, true)) {  // laws of too low a degree hide what is small, and make others seem needed
            search_.raiseDegrees(whole_.model);
            now_ = search_.left(whole_.model);
        }
        scores_ = score(whole_.model, record_, search_.test(), progress.part(0.0, 0.4)).scores;
    }
    auto trial = backed(scores_, strange_);
    if (trial.empty() && record_.noiseKnown && now_.chiSquaredPerValue < nearNoise)
        trial = possible(scores_, strange_);
    if (!trial.empty() && now_.chiSquaredPerValue > nearNoise)
        takeLeaderIn(trial, scores_, strange_);
    const auto linear = linearBeside(trial, scores_, strange_);
    if (trial.empty() && linear.empty())
        return Outcome::stuck;
    auto fuller = withAll(trial, linear, whole_.model, search_, progress);
    const auto tries = added(fuller, whole_.model);
    if (tries.empty())
        return Outcome::stuck;
    const auto summary = search_.fit(fuller, progress.part(0.4, 0.8));
    if (!summary.usable())
        return Outcome::stuck;
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
        takeIn(std::move(fuller), summary, then);
        return Outcome::grown;
    }
    if (strange_.empty() && before.empty() && !trial.empty() && trial.front()->vote.standsAlone())
        strange_ = tries;
    // else the next round would be this one again
    return strange_.empty() || strange_ == before ? Outcome::stuck : Outcome::again;
}

bool Growth::byTrial(const Progress& progress)
{
    constexpr double convincing = 3.0;  // dB
    if (!record_.noiseKnown || now_.chiSquaredPerValue < nearNoise || !search_.isFirstTrialOf(whole_.model))
        return false;
    auto laws = possible(scores_, {});
    std::erase_if(laws, [](const Score* s) { return s->effect->linear(); });
    struct Tried {
        Model model;
        FitSummary fit;
        Left left;
    };
    std::optional<Tried> best;
    double most = convincing;
    for (const auto* law : laws) {
        Tried one;
        one.fit = search_.tryLaw(one.model, *law, progress);
        if (!one.fit.usable() || !isAtWork(one.model.components.back()))
            continue;
        one.left = search_.left(one.model);
        if (const double gain = search_.lost(now_, one.left); gain > most) {
            most = gain;
            best = std::move(one);
        }
    }
    if (!best)
        return false;
    takeIn(std::move(best->model), best->fit, best->left);
    strange_.clear();
    return true;
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
        const auto outcome = growth.byVote(part.part(0.0, 0.8));
        if (outcome == Growth::Outcome::again)
            continue;
        if (outcome == Growth::Outcome::stuck && !growth.byTrial(part.part(0.8, 1.0)))
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
