// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Whole.h"

#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/FindCoupling.h"
#include "Engine/Diagnosis/Grow.h"
#include "Engine/Diagnosis/QuickFit.h"
#include "Engine/Diagnosis/Refine.h"
#include "Engine/Diagnosis/WholeSearch.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

namespace excursion {
namespace {

Whole wholeOf(Grown grown)
{
    Whole whole;
    whole.model = std::move(grown.model);
    whole.fit = std::move(grown.fit);
    whole.sectionsDrift = grown.sectionsDrift;
    return whole;
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
    auto alone = record;
    alone.sectionsDrift = false;  // its reference would be missing
    if (!quickFit(loud, alone, sections, options).usable())
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
    if (!found.whole.fit.usable() || found.whole.sectionsDrift)
        return found;
    search.chooseResiduals(found.whole.model);
    if (search.left(found.whole.model).isNoise())  // what is not needed would only hold up the refinement
        search.takeOut(found.whole.model, false, isNeeded, found.tried);
    if (isNear(found.whole, record) && warms(found.whole.model) && noiseHoldsDrift(record))
        return found;  // what warms is refined by another noise (see fitWhole)
    found.whole.fit = refine(found.whole.model, record, options, progress);
    return found;
}

/// What the base leads to, or its loudest level, whichever leaves less. A start is refined as soon as it has grown,
/// and the other one only tried where that does not come near the noise; but where growth ends far from the noise,
/// another start may lead further than any refinement.
Candidate best(const Model& base, const Record& record, WholeSearch& search, const FitOptions& options,
               bool mayBeCoupled, const Progress& progress)
{
    constexpr double far = 100.0;
    const auto begun = grown(base, record, search, {}, progress.part(0.0, 0.4));
    auto first = wholeOf(*begun);  // nobody has been anywhere before
    if (first.sectionsDrift)
        return {std::move(first), {}};
    if (mayBeCoupled && !isNear(first, record)) {
        // Another start, or a refinement, may lead further: only what leaves hardly anything of the error is believed.
        constexpr double hardly = 0.1;
        const double corner = findCoupling(first.model, record, options, hardly, progress.part(0.4, 0.4));
        if (corner > 0.0) {
            first.coupling = corner;
            return {std::move(first), {}};
        }
    }
    std::optional<Whole> second;
    auto growSecond = [&, done = false]() mutable {
        const auto loud = done ? std::nullopt : fittedToLoudest(base, record, options);
        done = true;
        if (loud)
            if (auto other = grown(*loud, record, search, begun->path, progress.part(0.4, 0.6)))
                second = wholeOf(std::move(*other));
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
        auto more = wholeOf(*grown(whole.model, record, search, {}, progress.part(0.0, 0.2)));
        if (more.sectionsDrift) {  // then another noise tells what is needed
            more.votes = std::move(whole.votes);
            return more;
        }
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
    bool there = false;  // at the noise, once
    const auto keeps = [&](const Removal& one) {
        const bool unknownLeft = !record.noiseKnown || whole.fit.chiSquaredPerValue > nearNoise;
        if (!one.plausible)
            return false;
        constexpr double doubtful = 1.0;  // dB, of what may only be another effect's wrong shape
        // At the noise an effect stays if the model would leave the noise without it; near the noise if it is missed.
        const bool completes = there ? whole.fit.chiSquaredPerValue * one.times > atNoise || !one.staysNoise
                                     : one.vote.uniqueDb > (one.suspect ? doubtful : hardlyNeeded);
        return unknownLeft ? one.vote.standsAlone()
                           : completes || (one.vote.backs() && !(one.suspect && one.vote.uniqueDb < doubtful));
    };
    constexpr int rounds = 3;  // what has gone may have held up another one
    for (int n = 0; n <= rounds; ++n) {
        const bool isThere = search.left(whole.model).isNoise();
        there = there || isThere;
        if (!isThere)
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

Whole fitWhole(const Model& base, const Record& record, const FitOptions& options, bool mayBeCoupled,
               const Progress& progress)
{
    WholeSearch search(base, record, options, progress);
    auto found = best(base, record, search, options, mayBeCoupled, progress.part(0.0, 0.6));
    if (found.whole.coupling > 0.0 || !(found.whole.fit.usable() || found.whole.sectionsDrift))
        return found.whole;
    auto nearer = record;
    const auto closely = [&](Whole from, const Progress& part) {
        WholeSearch closer(base, nearer, options, part);
        Candidate again {from, {}};
        const auto run = refine(again.whole.model, nearer, options, part.part(0.0, 0.3));
        if (!run.usable())
            return from;
        again.whole.fit = run;
        again.whole.sectionsDrift = false;
        auto whole = completed(std::move(again), nearer, closer, options, part.part(0.3, 1.0));
        whole.followsDrift = from.followsDrift;
        return whole;
    };
    auto whole = std::move(found.whole);
    whole.followsDrift = !whole.sectionsDrift && followsDrift(whole.model, record);
    if (!whole.followsDrift && !whole.sectionsDrift)
        whole = completed({std::move(whole), std::move(found.tried)}, record, search, options, progress.part(0.6, 0.8));
    if (whole.followsDrift) {
        takeDriftOutOfNoise(nearer);
        whole = closely(std::move(whole), progress.part(0.6, 0.8));
    }
    if (whole.sectionsDrift) {
        nearer.sectionsDrift = true;
        auto followed = closely(whole, progress.part(0.8, 1.0));
        // Moves may have come to stand for an effect that went.
        const auto reached = tryCompare(followed.model, nearer, {followed.fit.substeps, false}, progress.silent());
        const bool small = reached && reached->sectionMoves && reached->sectionMoves->areSmall();
        if (small)
            whole = std::move(followed);
        whole.sectionsDrift = small;
    }
    return whole;
}

}  // namespace excursion
