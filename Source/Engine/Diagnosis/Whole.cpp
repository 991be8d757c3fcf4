// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Whole.h"

#include "Engine/Diagnosis/Score.h"
#include "Engine/Diagnosis/Trial.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FeedbackError.h"
#include "Engine/Loudspeaker/FitResponse.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace excursion {
namespace {

constexpr double hardlyNeeded = 0.2;  // dB more that are left: what costs no more than that is not needed

/// An effect that a model has.
struct Tried {
    Vote vote;
    Model leaner;  ///< without it, fitted again; no components where that was not tried
    /// by which the mean squared residual grows without it; as if beyond measure where not tried
    double times = std::numeric_limits<double>::infinity();
    /// by which the error's power over the noise grows in the worst channel
    double powerTimes = std::numeric_limits<double>::infinity();
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
        glance_ = quick_;
        glance_.search = {1, 1e-1};
    }

    const ScoreOptions& test() const { return test_; }
    FitSummary fit(Model& model, const Progress& progress) const
    {
        return excursion::fit(model, record_, sections_, quick_, progress);
    }

    /// What a model leaves.
    struct Left {
        /// mean squared residual in units of the noise; infinite where a law's memory runs away
        double chi = std::numeric_limits<double>::infinity();
        double power =
            std::numeric_limits<double>::infinity();  ///< largest error power of a channel over that of its noise

        bool areNoise() const { return power <= ErrorPower::most; }
        bool isNoise() const { return areNoise() && chi < atNoise; }
    };
    Left left(const Model& model) const
    {
        OutputErrorOptions plain;
        plain.gradient = false;
        plain.threads = quick_.threads;
        const auto fits = quickError(model, record_, sections_, {}, plain);
        const auto sum = sumOf(fits);
        return sum ? Left {sum->cost / std::max(1.0, sum->rows),
                           record_.noiseKnown ? worstPower(fits) : std::numeric_limits<double>::infinity()}
                   : Left {};
    }

    /// By how many dB more a model leaves than another, beside what is noise for sure.
    double lost(const Left& more, const Left& less) const
    {
        const double sure = record_.noiseKnown && !less.areNoise() ? sureNoise : 0.0;
        const double least = (record_.noiseKnown ? 1.0 : 0.0) - sure;
        return 10.0 * std::log10(std::max(more.chi - sure, least) / std::max({less.chi - sure, least, 1e-300}));
    }

    /// Every effect of a model but those of the base. By derivatives it says little of an effect that has become a
    /// large part of the linear model, so one that seems to be needed little is really taken out.
    std::map<std::string, Tried> tryWithout(const Model& model) const
    {
        std::map<std::string, Tried> tried;
        const auto now = left(model);
        for (const auto& [effect, vote] : votesOf(model, record_, test_)) {
            if (base_.has(effect))
                continue;
            auto& one = tried[effect] = {vote, {}};
            if (vote.standsAlone())
                continue;
            auto leaner = withoutEffect(model, effect);
            if (!excursion::fit(leaner, record_, sections_, glance_).usable())
                continue;
            auto then = left(leaner);
            if (lost(then, now) < sorelyMissed) {
                if (!excursion::fit(leaner, record_, sections_, brief_).usable())
                    continue;
                then = left(leaner);
            }
            if (const double more = lost(then, now); more > vote.uniqueDb)
                one.vote = {more, effectNamed(effect).linear() ? 0.0 : vote.inconsistency};
            one.times = then.chi / now.chi;
            one.powerTimes = then.power / std::max(now.power, 1.0);
            one.leaner = std::move(leaner);
        }
        return tried;
    }

    /// Takes the effects out of which the others do not lose what `keeps` asks for, one at a time. What was found of
    /// them all where none was taken out, else nothing.
    template <class Keeps>
    std::optional<std::map<std::string, Tried>> takeOut(Model& model, const Keeps& keeps) const
    {
        bool any = false;
        auto every = tryWithout(model);
        for (auto& [effect, tried] : every) {
            if (keeps(tried))
                continue;
            auto leaner = any || tried.leaner.components.empty() ? withoutEffect(model, effect)
                                                                 : std::move(tried.leaner);
            if (any) {  // another one has gone, whose work it may do now
                if (!excursion::fit(leaner, record_, sections_, brief_).usable())
                    continue;
                const auto then = left(leaner), now = left(model);
                if (keeps(Tried {{lost(then, now), tried.vote.inconsistency},
                                 {},
                                 then.chi / now.chi,
                                 then.power / std::max(now.power, 1.0)}))
                    continue;
            }
            model = std::move(leaner);
            any = true;
        }
        if (any)
            return std::nullopt;
        return every;
    }

    void findPartsAnew(Model& model) const { excursion::findPartsAnew(model, record_, sections_, brief_); }

private:
    const Model& base_;
    const Record& record_;
    std::vector<std::size_t> sections_;
    ScoreOptions test_;
    FitOptions quick_, brief_, glance_;
    static constexpr double sorelyMissed = 15.0;  // dB more that are left: no fit would make that good
};

/// The model with every effect that the vote backs. Laws are at no strength; linear effects, the best first, are found
/// one after the other on the responses, and stay at rest where that leaves more.
Model withBacked(const Model& model, const Record& record, const std::vector<Score>& scores, const Search& search)
{
    Model fuller = model;
    const auto still = withoutLaws(model, record, search.test().threads);
    double now = search.left(model).chi;
    for (const auto& s : scores) {  // lowest first
        if (!s.vote.backs())
            continue;
        auto next = fuller;
        next.components.push_back(s.model.components.back());
        if (s.effect->linear() && fitNewestByResponse(next, still).usable())
            if (const double then = search.left(next).chi; then < now) {
                fuller = std::move(next);
                now = then;
                continue;
            }
        fuller.components.push_back(scaled(s.model.components.back(), 0.0));
    }
    return fuller;
}

}  // namespace

Whole fitWhole(const Model& base, const Record& record, const FitOptions& options, const Progress& progress)
{
    Whole whole {base, {}, {}};
    const Search search(base, record, options);
    constexpr int rounds = 4;
    constexpr double worthARound = 1.0;  // dB
    auto now = search.left(whole.model);
    for (int n = 0; n < rounds && !now.isNoise(); ++n) {
        const auto part = progress.part(0.7 * n / rounds, 0.7 * (n + 1) / rounds);
        auto fuller = withBacked(whole.model, record,
                                 score(whole.model, record, search.test(), part.part(0.0, 0.4)).scores, search);
        if (fuller.components.size() == whole.model.components.size())
            break;
        const auto summary = search.fit(fuller, part.part(0.4, 0.8));
        if (!summary.usable())
            break;
        search.findPartsAnew(fuller);
        search.takeOut(fuller, [](const Tried& tried) { return tried.vote.uniqueDb > hardlyNeeded; });
        const auto then = search.left(fuller);
        if (!(search.lost(now, then) > worthARound))
            break;
        now = then;
        whole.model = std::move(fuller);
        whole.fit = summary;
    }
    if (!whole.fit.usable())
        return whole;
    whole.fit = refine(whole.model, record, options, progress.part(0.7, 0.85));
    const bool unknownLeft = !record.noiseKnown || whole.fit.costPerResidual > nearNoise;
    auto tried = search.takeOut(whole.model, [&](const Tried& one) {
        return unknownLeft ? one.vote.standsAlone()
                           : whole.fit.costPerResidual * one.times > atNoise || one.powerTimes > ErrorPower::most;
    });
    if (!tried) {
        whole.fit = refine(whole.model, record, options, progress.part(0.85, 0.95));
        tried = search.tryWithout(whole.model);
    }
    for (const auto& [effect, one] : *tried)
        whole.votes[effect] = one.vote;
    return whole;
}

}  // namespace excursion
