// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Whole.h"

#include "Engine/Diagnosis/Score.h"
#include "Engine/Diagnosis/Trial.h"
#include "Engine/Driver/Catalogue.h"
#include "Engine/Driver/FeedbackError.h"
#include "Engine/Driver/FitResponse.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace excursion {
namespace {

constexpr double dispensable = 1.05;   // times what is left: what costs no more than that is not needed

/// An effect that a model has.
struct Tried {
    Vote vote;
    Model leaner;   ///< without it, fitted again; no components where that was not tried
};

/// The search for a whole: what all its steps share.
class Search {
public:
    Search(const Model& base, const Record& record, const FitOptions& options)
        : base_(base), record_(record), sections_(trialSections(record, 2)), quick_(options)
    {
        test_.threads = options.threads;
        quick_.fed = true;
        quick_.search = {12, 1e-3};
        brief_ = quick_;
        brief_.search = {5, 1e-2};
    }

    const ScoreOptions& test() const { return test_; }
    FitSummary fit(Model& model, const Progress& progress) const { return excursion::fit(model, record_, sections_, quick_, progress); }

    /// Mean squared residual in units of the noise; infinite where a law's memory runs away.
    double left(const Model& model) const
    {
        OutputErrorOptions plain;
        plain.gradient = false;
        plain.threads = quick_.threads;
        const auto sum = sumOf(quickError(model, record_, sections_, {}, plain));
        return sum ? sum->cost / std::max(1.0, sum->rows) : std::numeric_limits<double>::infinity();
    }

    /// Every effect of a model but those of the base. By derivatives it says little of an effect that has become a large part of the linear model, so one
    /// that seems to be needed little is really taken out.
    std::map<std::string, Tried> tryWithout(const Model& model) const
    {
        std::map<std::string, Tried> tried;
        const double now = std::max(left(model), record_.noiseKnown ? 1.0 : 0.0);
        for (const auto& [effect, vote] : votesOf(model, record_, test_)) {
            if (base_.has(effect))
                continue;
            auto& one = tried[effect] = {vote, {}};
            if (vote.standsAlone())
                continue;
            auto leaner = withoutEffect(model, effect);
            if (!excursion::fit(leaner, record_, sections_, brief_).usable)
                continue;
            if (const double lost = 10.0 * std::log10(std::max(left(leaner), now) / now); lost > vote.uniqueDb)
                one.vote = {lost, effectNamed(effect).linear() ? 0.0 : vote.inconsistency};
            one.leaner = std::move(leaner);
        }
        return tried;
    }

    /// Takes the effects out of which the others do not lose what `keeps` asks for, one at a time; true if there were any.
    template <class Keeps>
    bool takeOut(Model& model, const Keeps& keeps) const
    {
        bool any = false;
        for (auto& [effect, tried] : tryWithout(model)) {
            if (keeps(tried.vote))
                continue;
            auto leaner = any || tried.leaner.components.empty() ? withoutEffect(model, effect) : std::move(tried.leaner);
            if (any) {   // another one has gone, whose work it may do now
                if (!excursion::fit(leaner, record_, sections_, brief_).usable)
                    continue;
                if (keeps(Vote {10.0 * std::log10(left(leaner) / left(model)), tried.vote.inconsistency}))
                    continue;
            }
            model = std::move(leaner);
            any = true;
        }
        return any;
    }

    void findPartsAnew(Model& model) const { excursion::findPartsAnew(model, record_, sections_, brief_); }

private:
    const Model& base_;
    const Record& record_;
    std::vector<std::size_t> sections_;
    ScoreOptions test_;
    FitOptions quick_, brief_;
};

/// The model with every effect that the vote backs. Laws are at no strength; linear effects, the best first, are found one after the other on the
/// responses, and stay at rest where that leaves more.
Model withBacked(const Model& model, const Record& record, const std::vector<Score>& scores, const Search& search)
{
    Model fuller = model;
    const auto still = withoutLaws(model, record, search.test().threads);
    double now = search.left(model);
    for (const auto& s : scores) {   // lowest first
        if (!s.vote.backs())
            continue;
        auto next = fuller;
        next.components.push_back(s.model.components.back());
        if (s.effect->linear() && fitNewestByResponse(next, still).usable)
            if (const double then = search.left(next); then < now) {
                fuller = std::move(next);
                now = then;
                continue;
            }
        fuller.components.push_back(scaled(s.model.components.back(), 0.0));
    }
    return fuller;
}

} // namespace

Whole fitWhole(const Model& base, const Record& record, const FitOptions& options, const Progress& progress)
{
    Whole whole {base, {}, {}};
    whole.fit.usable = false;
    const Search search(base, record, options);
    constexpr int rounds = 4;
    constexpr double worthARound = 0.8;
    double now = search.left(whole.model);
    for (int n = 0; n < rounds && !(record.noiseKnown && now < atNoise); ++n) {
        const auto part = progress.part(0.7 * n / rounds, 0.7 * (n + 1) / rounds);
        auto fuller = withBacked(whole.model, record, score(whole.model, record, search.test(), part.part(0.0, 0.4)).scores, search);
        if (fuller.components.size() == whole.model.components.size())
            break;
        const auto summary = search.fit(fuller, part.part(0.4, 0.8));
        if (!summary.usable)
            break;
        search.findPartsAnew(fuller);
        search.takeOut(fuller, [](const Vote& vote) { return vote.uniqueDb > 10.0 * std::log10(dispensable); });
        const double then = search.left(fuller);
        if (!(then < worthARound * now))
            break;
        now = then;
        whole.model = std::move(fuller);
        whole.fit = summary;
    }
    if (!whole.fit.usable)
        return whole;
    whole.fit = refine(whole.model, record, options, progress.part(0.7, 0.85));
    const bool unknownLeft = !record.noiseKnown || whole.fit.costPerResidual > nearNoise;
    if (search.takeOut(whole.model, [&](const Vote& vote) {
            return unknownLeft ? vote.standsAlone() : whole.fit.costPerResidual * std::pow(10.0, vote.uniqueDb / 10.0) > atNoise;
        }))
        whole.fit = refine(whole.model, record, options, progress.part(0.85, 0.95));
    for (const auto& [effect, tried] : search.tryWithout(whole.model))
        whole.votes[effect] = tried.vote;
    return whole;
}

} // namespace excursion
