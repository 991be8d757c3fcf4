// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Whole.h"

#include "Engine/Diagnosis/Score.h"
#include "Engine/Diagnosis/Trial.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FeedbackError.h"
#include "Engine/Loudspeaker/FitResponse.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <set>

namespace excursion {
namespace {

constexpr double hardlyNeeded = 0.2;  // dB more that are left: what costs no more than that is not needed

double decibels(double ratio) { return 10.0 * std::log10(ratio); }

/// An effect that a model has.
struct Tried {
    Vote vote;
    Model leaner;  ///< without it, fitted again; no components where that was not tried
    /// by which the mean squared residual grows without it; as if beyond measure where not tried
    double times = std::numeric_limits<double>::infinity();
    bool staysNoise = false;  ///< every channel's error without it
    bool plausible = true;    ///< as it stands in the model; else it stands for something else
};

/// The effects of a model whose parameters are no longer what their names say.
std::set<std::string> implausible(const Model& model)
{
    std::set<std::string> found;
    for (std::size_t k = 1; k < model.components.size(); ++k) {
        const auto& one = model.components[k];
        if (!one.effect->plausible(one.operatingRange, one.parameters, model.base().parameters))
            found.insert(one.effect->id());
    }
    return found;
}

/// The search for a whole: what all its steps share.
class Search {
public:
    Search(const Model& base, const Record& record, const FitOptions& options)
        : base_(base), record_(record), sections_(trialSections(record, 2)), options_(options)
    {
        test_.threads = options.threads;
    }

    /// Judges by what a simulation leaves of this model from here on, where that is less than what fed laws leave.
    void chooseResiduals(const Model& model)
    {
        options_.substeps = 0;  // chosen for this model
        excursion::chooseResiduals(options_, test_, model, record_, sections_);
    }

    const ScoreOptions& test() const { return test_; }
    FitSummary fit(Model& model, const Progress& progress) const { return fit(model, {12, 1e-3}, progress); }

    /// What a model leaves of a channel.
    struct Channel {
        double chiSquaredPerValue = 0.0;  ///< mean squared residual in units of the noise
        double power = 0.0;  ///< of the error over that of the noise; infinite where the noise is not known

        bool isNoise() const { return power <= ErrorPower::most; }
    };
    /// What a model leaves; no channels where a law's memory runs away.
    struct Left {
        double chiSquaredPerValue = std::numeric_limits<double>::infinity();  ///< of all channels
        double cost = std::numeric_limits<double>::infinity();
        std::vector<Channel> channels;

        bool areNoise() const
        {
            return !channels.empty()
                   && std::all_of(channels.begin(), channels.end(), [](const Channel& c) { return c.isNoise(); });
        }
        bool isNoise() const { return areNoise() && chiSquaredPerValue < atNoise; }
    };
    Left left(const Model& model) const
    {
        OutputErrorOptions plain;
        plain.gradient = false;
        plain.played = test_.played;
        plain.substeps = test_.substeps;
        plain.threads = options_.threads;
        const auto fits = quickError(model, record_, sections_, {}, plain);
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

    /// By how many dB more a model leaves than another, in the channel that tells most: of the mean over all lines,
    /// beside what is noise for sure, or of the power, which may stand in a few lines, over that of the noise.
    double lost(const Left& more, const Left& less) const
    {
        if (more.channels.empty() || less.channels.empty())
            return more.channels.empty() == less.channels.empty() ? 0.0
                   : more.channels.empty()                        ? std::numeric_limits<double>::infinity()
                                                                  : -std::numeric_limits<double>::infinity();
        double most = -std::numeric_limits<double>::infinity();
        for (std::size_t c = 0; c < less.channels.size(); ++c) {
            const double sure = record_.noiseKnown && !less.channels[c].isNoise() ? sureNoise : 0.0;
            const double least = record_.noiseKnown ? 0.5 * (1.0 - sure) : 0.0;
            most = std::max(most, decibels(std::max(more.channels[c].chiSquaredPerValue - sure, least)
                                           / std::max({less.channels[c].chiSquaredPerValue - sure, least, 1e-300})));
            if (record_.noiseKnown)
                most = std::max(
                    most, decibels(std::max(more.channels[c].power, 1.0) / std::max(less.channels[c].power, 1.0)));
        }
        return most;
    }

    /// Every effect of a model but those of the base. By derivatives it says little of an effect that has become a
    /// large part of the linear model, so one that seems to be needed little is really taken out.
    /// @param thorough  what seems to be missed is fitted with a simulation's own slopes before that is believed: where
    ///                  laws rule the motion those of fed laws lead no further than near the least error
    std::map<std::string, Tried> tryWithout(const Model& model, bool thorough) const
    {
        std::map<std::string, Tried> tried;
        const auto now = left(model);
        const auto strange = implausible(model);
        for (const auto& [effect, vote] : votesOf(model, record_, test_)) {
            if (base_.has(effect))
                continue;
            auto& one = tried[effect] = {vote, {}};
            one.plausible = !strange.contains(effect);
            if (vote.standsAlone() && one.plausible)
                continue;
            auto leaner = withoutEffect(model, effect);
            if (!fit(leaner, glance).usable())
                continue;
            auto then = left(leaner);
            if (lost(then, now) < sorelyMissed) {
                if (!fit(leaner, brief).usable())
                    continue;
                then = left(leaner);
                if (effectNamed(effect).linear() && lost(then, now) < barelyMissed && reshape(leaner, then, now))
                    then = left(leaner);
                if (thorough && test_.played && lost(then, now) > hardlyNeeded && fitExactly(leaner).usable())
                    then = left(leaner);
            }
            one.vote = votedBy(effect, vote, then, now);
            one.times = then.chiSquaredPerValue / now.chiSquaredPerValue;
            one.staysNoise = then.areNoise();
            one.leaner = std::move(leaner);
        }
        return tried;
    }

    /// The vote on an effect that was really taken out. At the noise what it explains is what is left more without it,
    /// not the little that derivatives say of that; while more is missing the doubt of these stands.
    Vote votedBy(const std::string& effect, const Vote& vote, const Left& without, const Left& with) const
    {
        const double explained = std::max(without.cost - with.cost, 1e-300);
        return {lost(without, with),
                effectNamed(effect).linear() ? 0.0
                : with.areNoise()            ? vote.byLevel / explained
                                             : vote.inconsistency,
                vote.byLevel};
    }

    /// Takes the effects out of which the others do not lose what `keeps` asks for, one at a time. What was found of
    /// them all where none was taken out, else nothing.
    template <class Keeps>
    std::optional<std::map<std::string, Tried>> takeOut(Model& model, bool thorough, const Keeps& keeps) const
    {
        bool any = false;
        auto every = tryWithout(model, thorough);
        std::vector<std::pair<const std::string, Tried>*> order;  // the least needed first
        for (auto& one : every)
            order.push_back(&one);
        std::stable_sort(order.begin(), order.end(),
                         [](auto* a, auto* b) { return a->second.vote.uniqueDb < b->second.vote.uniqueDb; });
        for (auto* one : order) {
            auto& [effect, tried] = *one;
            if (keeps(tried))
                continue;
            const bool fitted = !any && !tried.leaner.components.empty();
            auto leaner = fitted ? std::move(tried.leaner) : withoutEffect(model, effect);
            if (!fitted) {  // also when another one has gone, whose work it may do now
                if (!fit(leaner, brief).usable() || (thorough && test_.played && !fitExactly(leaner).usable()))
                    continue;
                const auto then = left(leaner), now = left(model);
                if (keeps(Tried {votedBy(effect, tried.vote, then, now),
                                 {},
                                 then.chiSquaredPerValue / now.chiSquaredPerValue,
                                 then.areNoise(),
                                 !implausible(model).contains(effect)}))
                    continue;
            }
            model = std::move(leaner);
            any = true;
        }
        if (any)
            return std::nullopt;
        return every;
    }

    /// Takes out what stands for something else; returns what that was.
    std::set<std::string> takeOutImplausible(Model& model) const
    {
        auto strange = implausible(model);
        std::erase_if(strange, [&](const std::string& effect) { return base_.has(effect); });
        auto leaner = model;
        for (const auto& effect : strange)
            leaner = withoutEffect(leaner, effect);
        if (strange.empty() || !fit(leaner, brief).usable())
            return {};
        model = std::move(leaner);
        return strange;
    }

    /// What seems to miss a linear effect a little may only have another of its linear effects in a wrong shape, from
    /// which no small step leads to the right one: each is found anew on the responses. Whether that helped.
    bool reshape(Model& model, const Left& now, const Left& enough) const
    {
        const auto still = withoutLaws(model, record_, options_.threads);
        auto best = now;
        bool helped = false;
        for (std::size_t k = 1; k < model.components.size() && lost(best, enough) > hardlyNeeded; ++k) {
            if (!model.components[k].effect->linear() || base_.has(model.components[k].effect->id()))
                continue;
            auto anew = model;
            if (!fitByResponse(anew, k, still).usable() || !fit(anew, brief).usable())
                continue;
            if (auto then = left(anew);
                lost(best, then) > hardlyNeeded && then.chiSquaredPerValue < best.chiSquaredPerValue) {
                model = std::move(anew);
                best = std::move(then);
                helped = true;
            }
        }
        return helped;
    }

    void findPartsAnew(Model& model) const { excursion::findPartsAnew(model, record_, sections_, within(brief)); }

private:
    FitOptions within(const LeastSquaresOptions& search) const
    {
        auto options = options_;
        options.search = search;
        return options;
    }
    /// Of models that are played anyhow: with the simulation's own slopes.
    FitSummary fitExactly(Model& model) const
    {
        auto options = within(brief);
        options.fedGradient = false;
        return excursion::fit(model, record_, sections_, options, {});
    }
    FitSummary fit(Model& model, const LeastSquaresOptions& search, const Progress& progress = {}) const
    {
        return quickFit(model, record_, sections_, within(search), progress);
    }

    const Model& base_;
    const Record& record_;
    std::vector<std::size_t> sections_;
    ScoreOptions test_;
    FitOptions options_;
    static constexpr LeastSquaresOptions brief {5, 1e-2}, glance {1, 1e-1};
    static constexpr double barelyMissed = 6.0;   // dB
    static constexpr double sorelyMissed = 15.0;  // dB more that are left: no fit would make that good
};

/// The model with every effect that the vote backs. Laws are at no strength; linear effects, the best first, are found
/// one after the other on the responses, and stay at rest where that leaves more.
Model withBacked(const Model& model, const Record& record, const std::vector<Score>& scores,
                 const std::set<std::string>& without, const Search& search)
{
    Model fuller = model;
    const auto still = withoutLaws(model, record, search.test().threads);
    double now = search.left(model).chiSquaredPerValue;
    for (const auto& s : scores) {  // lowest first
        if (!s.vote.backs() || without.contains(s.effect->id()))
            continue;
        auto next = fuller;
        next.components.push_back(s.model.components.back());
        if (s.effect->linear() && fitNewestByResponse(next, still).usable())
            if (const double then = search.left(next).chiSquaredPerValue; then < now) {
                fuller = std::move(next);
                now = then;
                continue;
            }
        fuller.components.push_back(scaled(s.model.components.back(), 0.0));
    }
    return fuller;
}

/// The effects that rounds of voting put into a base, and what the last of them was fitted to.
Whole grown(const Model& base, const Record& record, Search& search, const Progress& progress)
{
    Whole whole {base, {}, {}};
    constexpr int rounds = 4;
    constexpr double worthARound = 1.0;  // dB
    search.chooseResiduals(base);
    auto now = search.left(whole.model);
    std::set<std::string> strange;  // stood for something else in the last round: others come first in this one
    for (int n = 0; n < rounds && !now.isNoise(); ++n) {
        const auto part = progress.part(static_cast<double>(n) / rounds, (n + 1.0) / rounds);
        auto fuller = withBacked(whole.model, record,
                                 score(whole.model, record, search.test(), part.part(0.0, 0.4)).scores, strange,
                                 search);
        if (fuller.components.size() == whole.model.components.size())
            break;
        const auto summary = search.fit(fuller, part.part(0.4, 0.8));
        if (!summary.usable())
            break;
        strange = search.takeOutImplausible(fuller);
        search.chooseResiduals(fuller);
        now = search.left(whole.model);
        auto then = search.left(fuller);
        if (!then.isNoise()) {  // else there is nothing more to find, and what is not needed goes in the end
            search.findPartsAnew(fuller);
            search.takeOut(fuller, false, [](const Tried& tried) { return tried.vote.uniqueDb > hardlyNeeded; });
            then = search.left(fuller);
        }
        if (!(search.lost(now, then) > worthARound)) {
            if (strange.empty())
                break;
            continue;
        }
        now = then;
        whole.model = std::move(fuller);
        whole.fit = summary;
    }
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
    if (!quickFit(loud, record, sections, options).usable())
        return std::nullopt;
    return loud;
}

}  // namespace

Whole fitWhole(const Model& base, const Record& record, const FitOptions& options, const Progress& progress)
{
    Search search(base, record, options);
    Whole whole = grown(base, record, search, progress.part(0.0, 0.4));
    if (const auto loud = fittedToLoudest(base, record, options); loud && !search.left(whole.model).isNoise()) {
        auto other = grown(*loud, record, search, progress.part(0.4, 0.7));
        search.chooseResiduals(whole.model);
        if (other.fit.usable()
            && search.left(other.model).chiSquaredPerValue < search.left(whole.model).chiSquaredPerValue)
            whole = std::move(other);
    }
    if (!whole.fit.usable())
        return whole;
    whole.fit = refine(whole.model, record, options, progress.part(0.7, 0.85));
    search.chooseResiduals(whole.model);
    const auto keeps = [&](const Tried& one) {
        const bool unknownLeft = !record.noiseKnown || whole.fit.chiSquaredPerValue > nearNoise;
        if (!one.plausible)
            return false;
        return unknownLeft ? one.vote.standsAlone()
                           : one.vote.backs() || whole.fit.chiSquaredPerValue * one.times > atNoise || !one.staysNoise;
    };
    constexpr int rounds = 3;  // what has gone may have held up another one
    auto tried = search.takeOut(whole.model, true, keeps);
    for (int n = 1; n <= rounds && !tried; ++n) {
        whole.fit = refine(whole.model, record, options, progress.part(0.85, 0.95));
        tried = n < rounds ? search.takeOut(whole.model, true, keeps) : search.tryWithout(whole.model, false);
    }
    for (const auto& [effect, one] : *tried)
        whole.votes[effect] = one.vote;
    return whole;
}

}  // namespace excursion
