// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Whole.h"

#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/QuickFit.h"
#include "Engine/Diagnosis/Refine.h"
#include "Engine/Diagnosis/WholeSearch.h"
#include "Engine/Loudspeaker/FeedbackError.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
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

bool isNeeded(const Removal& removal) { return removal.vote.uniqueDb > hardlyNeeded; }

/// Where a round of a search has ended.
struct Waypoint {
    std::vector<std::string> effects;
    double chiSquaredPerValue = 0.0;
};
using Path = std::vector<Waypoint>;

/// Whether a search has been there: what follows would be the same.
bool leadsBy(const Path& path, const Waypoint& place)
{
    constexpr double same = 1e-3;
    return std::any_of(path.begin(), path.end(), [&](const Waypoint& one) {
        return one.effects == place.effects
               && std::abs(one.chiSquaredPerValue - place.chiSquaredPerValue) < same * place.chiSquaredPerValue;
    });
}

/// Puts effects into a whole by rounds of voting. Whether it came to where no other search has been.
/// @param path   of this search, to which it adds
/// @param known  of another search
bool grow(Whole& whole, const Model& base, const Record& record, WholeSearch& search, Path& path, const Path& known,
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
        path.push_back({whole.model.effectIds(), now.chiSquaredPerValue});
        if (leadsBy(known, path.back()))
            return false;
    }
    return true;
}

/// A model that has grown, and how.
struct Grown {
    Whole whole;
    Path path;
};

/// The effects that the record shows beside those of a base, and what the last of them was fitted to. None where it
/// comes to where another search has been.
std::optional<Grown> grown(const Model& base, const Record& record, WholeSearch& search, const Path& known,
                           const Progress& progress)
{
    Grown result;
    auto& [whole, path] = result;
    whole.model = base;
    if (!grow(whole, base, record, search, path, known, progress.part(0.0, 0.7)))
        return std::nullopt;
    if (search.exchangeStandIns(whole.model, progress.part(0.7, 0.8))) {  // beside the right ones others may show
        auto fitted = whole.model;
        if (const auto summary = search.fit(fitted, progress.part(0.8, 0.82)); summary.usable()) {
            whole.model = std::move(fitted);
            whole.fit = summary;
        }
        if (!grow(whole, base, record, search, path, known, progress.part(0.82, 1.0)))
            return std::nullopt;
    }
    return result;
}

/// A model without laws as the loudest level alone makes it: where friction holds the cone of a quiet one, the common
/// fit lies between two suspensions, and no small step leads from there to either. None of a model with laws, and of
/// one level.
std::optional<Model> fittedToLoudest(const Model& model, const Record& record, const FitOptions& options)
{
    const auto every = estimationSections(record);
    int loudest = -1;
    for (const auto s : every)
        loudest = std::max(loudest, record.sections[s].level);
    std::vector<std::size_t> sections;
    std::copy_if(every.begin(), every.end(), std::back_inserter(sections),
                 [&](std::size_t s) { return record.sections[s].level == loudest; });
    if (sections.size() == every.size() || hasLaws(model))
        return std::nullopt;
    auto loud = model;
    if (!quickFit(loud, record, sections, options).usable())
        return std::nullopt;
    return loud;
}

/// A whole, and what was found of its effects on trial.
struct Candidate {
    Whole whole;
    WholeSearch::Removals tried;
};

/// Whether another start could not lead much further.
bool isNear(const Whole& whole, const Record& record)
{
    return whole.fit.usable() && record.noiseKnown && whole.fit.chiSquaredPerValue < nearNoise;
}

Candidate refined(Whole whole, const Record& record, WholeSearch& search, const FitOptions& options,
                  const Progress& progress)
{
    Candidate found {std::move(whole), {}};
    if (!found.whole.fit.usable())
        return found;
    search.chooseResiduals(found.whole.model);
    if (search.left(found.whole.model).isNoise())  // what is not needed would only hold up the refinement
        search.takeOut(found.whole.model, false, isNeeded, found.tried);
    if (isNear(found.whole, record) && warms(found.whole.model) && hasSilentNoise(record))
        return found;  // what warms is refined by another noise (see fitWhole)
    found.whole.fit = refine(found.whole.model, record, options, progress);
    return found;
}

/// What the base leads to, or its loudest level, whichever leaves less. A start is refined as soon as it has grown,
/// and the other one only tried where that does not come near the noise; but where growth ends far from the noise,
/// another start may lead further than any refinement.
Candidate best(const Model& base, const Record& record, WholeSearch& search, const FitOptions& options,
               const Progress& progress)
{
    constexpr double far = 100.0;
    const auto begun = grown(base, record, search, {}, progress.part(0.0, 0.4));
    auto first = begun->whole;  // nobody has been anywhere before
    std::optional<Whole> second;
    auto growSecond = [&, done = false]() mutable {
        const auto loud = done ? std::nullopt : fittedToLoudest(base, record, options);
        done = true;
        if (loud)
            if (auto other = grown(*loud, record, search, begun->path, progress.part(0.4, 0.6)))
                second = std::move(other->whole);
    };
    const auto leaves = [&](const Whole& one) {
        return one.fit.usable() ? search.left(one.model).chiSquaredPerValue : std::numeric_limits<double>::infinity();
    };
    if (!(leaves(first) < far)) {
        growSecond();
        search.chooseResiduals(first.model);
        if (second && leaves(*second) < leaves(first))
            std::swap(first, *second);
    }
    auto found = refined(std::move(first), record, search, options, progress.part(0.6, 0.8));
    if (isNear(found.whole, record))
        return found;
    if (!second)
        growSecond();
    if (!second)
        return found;
    auto other = refined(std::move(*second), record, search, options, progress.part(0.8, 1.0));
    search.chooseResiduals(found.whole.model);
    if (leaves(other.whole) < leaves(found.whole))
        return other;
    return found;
}

/// What a refined candidate still lacks or has too much of.
Whole completed(Candidate found, const Record& record, WholeSearch& search, const FitOptions& options,
                const Progress& progress)
{
    auto& whole = found.whole;
    auto& tried = found.tried;
    search.chooseResiduals(whole.model);
    if (!search.left(whole.model).isNoise()) {  // laws of a higher degree may have laid bare what is small
        auto more = grown(whole.model, record, search, {}, progress.part(0.0, 0.2))->whole;
        if (more.fit.usable()) {
            more.fit = refine(more.model, record, options, progress.part(0.2, 0.4));
            whole = std::move(more);
            tried.clear();
        }
        search.chooseResiduals(whole.model);
    }
    if (search.restImplausibleParts(whole.model)) {
        whole.fit = refine(whole.model, record, options, progress.part(0.4, 0.5));
        tried.clear();
    }
    const auto keeps = [&](const Removal& one) {
        const bool unknownLeft = !record.noiseKnown || whole.fit.chiSquaredPerValue > nearNoise;
        if (!one.plausible)
            return false;
        return unknownLeft ? one.vote.standsAlone()
                           : one.vote.backs() || whole.fit.chiSquaredPerValue * one.times > atNoise || !one.staysNoise;
    };
    constexpr int rounds = 3;  // what has gone may have held up another one
    for (int n = 0; n <= rounds; ++n) {
        if (!search.left(whole.model).isNoise())
            tried.clear();  // while something is missing, an effect may only seem to be missed beside others
        if (n == rounds)
            tried = search.tryWithout(whole.model, false);
        else if (search.takeOut(whole.model, true, keeps, tried))
            whole.fit = refine(whole.model, record, options, progress.part(0.5, 0.9));
        else
            break;
    }
    for (const auto& [effect, one] : tried)
        whole.votes[effect] = one.vote;
    return whole;
}

}  // namespace

Whole fitWhole(const Model& base, const Record& record, const FitOptions& options, const Progress& progress)
{
    WholeSearch search(base, record, options);
    auto found = best(base, record, search, options, progress.part(0.0, 0.7));
    if (!found.whole.fit.usable())
        return found.whole;
    if (!followsDrift(found.whole.model, record))
        return completed(std::move(found), record, search, options, progress.part(0.7, 1.0));
    auto silent = record;
    useSilentNoise(silent);
    WholeSearch closer(base, silent, options);
    found.tried.clear();
    auto closely = found.whole.model;
    const auto run = refine(closely, silent, options, progress.part(0.7, 0.8));
    if (!run.usable())
        return found.whole;
    found.whole.model = std::move(closely);
    found.whole.fit = run;
    auto whole = completed(std::move(found), silent, closer, options, progress.part(0.8, 1.0));
    whole.silentNoise = true;
    return whole;
}

}  // namespace excursion
