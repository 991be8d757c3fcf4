// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/RungsTo.h"

#include "Engine/Diagnosis/Reason.h"
#include "Engine/Diagnosis/Score.h"
#include "Engine/Diagnosis/QuickFit.h"
#include "Engine/Loudspeaker/Catalogue.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

/// The whole with some of its effects only, as many as a model has and one more.
Model partOf(const Whole& whole, const Model& model, const std::string& more)
{
    auto part = whole.model;
    std::erase_if(part.components, [&](const Component& c) {
        return &c != &part.components.front() && !model.has(c.effect->id()) && c.effect->id() != more;
    });
    part.covariance.resize(0, 0);
    return part;
}

/// Of each parameter of a part's components, its place among those of the whole.
std::vector<Eigen::Index> placesIn(const Model& whole, const Model& part)
{
    std::vector<Eigen::Index> places;
    for (const auto& component : part.components) {
        const auto same = std::find_if(whole.components.begin(), whole.components.end(),
                                       [&](const Component& one) { return one.effect == component.effect; });
        auto place = firstParameterOf(whole, static_cast<std::size_t>(same - whole.components.begin()));
        for (std::size_t k = 0; k < component.parameters.size(); ++k)
            places.push_back(place++);
    }
    return places;
}

/// Laws that a fit held have the errors of the whole, whose they are.
void takeErrors(Model& part, const std::vector<bool>& held, const Model& whole)
{
    if (part.covariance.size() == 0 || whole.covariance.size() == 0)
        return;
    const auto places = placesIn(whole, part);
    const auto all = parametersOf(part);
    const auto known = parametersOf(whole);
    for (std::size_t k = 0; k < places.size(); ++k)
        if (held[k]) {
            const auto row = static_cast<Eigen::Index>(k);
            for (std::size_t j = 0; j < places.size(); ++j)
                if (held[j])
                    part.covariance(row, static_cast<Eigen::Index>(j)) = whole.covariance(places[k], places[j]);
            all[k]->standardError = known[static_cast<std::size_t>(places[k])]->standardError;
        }
    part.inverseCurvature.resize(0, 0);  // of another fit
}

/// Fits what is linear of a part, beside effects that stay as the whole has them: free ones would stand for what the
/// part lacks, with shapes that no loudspeaker has.
FitSummary fitLinear(Model& part, const Model& whole, const Record& record, const FitOptions& options,
                     const Progress& progress)
{
    followOthers(part);
    std::vector<bool> free, held;
    for (auto& component : part.components)
        for (auto& p : component.parameters) {
            const bool law = &component != &part.components.front() && !component.effect->linear();
            free.push_back(p.free);
            held.push_back(p.free && law);
            p.free = p.free && !law;
        }
    auto fit = fitFed(part, record, estimationSections(record), options, progress);
    auto was = free.begin();
    for (auto& component : part.components)
        for (auto& p : component.parameters)
            p.free = *was++;
    takeErrors(part, held, whole);
    return fit;
}

/// A rung with one more effect of the whole that is not at work yet: what only holds together runs away in parts.
Rung atRest(const Rung& rung, const std::vector<Score>& scores, const Whole& whole)
{
    const auto& candidate = *std::find_if(scores.begin(), scores.end(),
                                          [&](const Score& s) { return whole.model.has(s.effect->id()); });
    Rung next;
    next.added = candidate.effect->id();
    next.predictedErrorDb = candidate.errorDb;
    next.model = withComponent(rung.model, scaled(candidate.model.components.back(), 0.0));
    next.fit = rung.fit;
    next.comparison = rung.comparison;
    return next;
}

/// How often an effect of a whole is there, by its merit: the share of what would be left without it that it explains,
/// as far as that is the same at all levels. Counted on virtual loudspeakers (Docs/Method.md): what a whole keeps is
/// nearly always there, whatever its merit; but beside something unknown that has little may stand for a part of it.
double confidenceOf(const Vote& vote, bool besideUnknown)
{
    const double least = besideUnknown ? 0.60 : 0.90;
    constexpr double most = 0.985;
    constexpr double untold = 0.3;  // of one level
    const double inconsistency = std::isnan(vote.inconsistency) ? untold : vote.inconsistency;
    const double merit = std::max(0.0, 1.0 - std::pow(10.0, -vote.uniqueDb / 10.0))
                         * std::clamp(1.0 - inconsistency, 0.0, 1.0);
    return least + (most - least) * merit;
}

/// Whether something that no model follows passes for noise.
bool wanders(const Comparison& comparison)
{
    return std::any_of(comparison.channels.begin(), comparison.channels.end(),
                       [](const ChannelComparison& c) { return c.wanderDb.has_value(); });
}

/// What is said of a rung whose next effect is known.
/// @param besideUnknown  the whole leaves more than noise, or what is told as noise is not
Diagnosis diagnosisOf(const Rung& rung, const Rung& next, const std::vector<Score>& scores, const Whole& whole,
                      bool besideUnknown)
{
    Diagnosis diagnosis;
    diagnosis.verdict = Verdict::missingEffect;
    const auto ids = whole.model.effectIds();
    const auto others = std::count_if(ids.begin(), ids.end(),
                                      [&](const std::string& id) { return id != next.added && !rung.model.has(id); });
    diagnosis.error = errorByChannel(rung.comparison);
    diagnosis.remainder = remainderOf(rung.comparison);
    for (const auto& candidate : scores) {
        auto entry = promisedBy(candidate);
        auto errorAfter = candidate.errorDb;
        if (const auto needed = whole.votes.find(entry.effect); needed != whole.votes.end()) {
            entry.vote = needed->second;
            entry.significant = true;
            entry.confidence = confidenceOf(entry.vote, besideUnknown);
        }
        if (entry.effect == next.added) {
            entry.confirmedChiSquaredPerValue = next.comparison.chiSquaredPerValue;
            for (const auto& channel : next.comparison.channels)
                entry.confirmedErrorDb[channel.quantity] = channel.total.db;
            errorAfter = entry.confirmedErrorDb;
            entry.model = next.model;
        }
        entry.reason = reasonFor(*candidate.effect, entry.model, rung.comparison, errorAfter);
        diagnosis.ranking.push_back(std::move(entry));
    }
    std::stable_sort(diagnosis.ranking.begin(), diagnosis.ranking.end(),
                     [&](const RankedEffect& a, const RankedEffect& b) {
                         const auto place = [&](const RankedEffect& r) {
                             return r.effect == next.added ? 0 : r.significant ? 1 : 2;
                         };
                         return place(a) != place(b) ? place(a) < place(b)
                                                     : a.predictedChiSquaredPerValue < b.predictedChiSquaredPerValue;
                     });
    diagnosis.sentence = effectNamed(next.added).title() + " is missing"
                         + (others > 1 ? ", and " + std::to_string(others) + " other effects explain what it does not."
                            : others > 0 ? ", and another effect explains what it does not."
                                         : ".");
    return diagnosis;
}

}  // namespace

std::vector<Rung> rungsTo(const Whole& whole, Rung base, const Record& record, const DiagnoseOptions& options,
                          const Progress& progress)
{
    const auto reached = tryCompare(whole.model, record, {whole.fit.substeps, true}, progress.silent());
    if (!reached)
        return {};
    const bool besideUnknown = record.noiseKnown && (!(reached->chiSquaredPerValue < nearNoise) || wanders(*reached));
    const auto count = static_cast<double>(whole.model.components.size() - base.model.components.size());
    ScoreOptions test;
    test.threads = options.fit.threads;
    test.shapes = &whole.model;
    FitOptions brief = options.fit;
    brief.search = {4, 1e-2};
    std::vector<Rung> rungs {std::move(base)};
    for (double n = 0.0; n < count; ++n) {
        const auto part = progress.part(n / count, (n + 1.0) / count);
        auto& rung = rungs.back();
        const auto scores = score(rung.model, record, test, part.part(0.0, 0.4)).scores;  // lowest first
        Rung next;
        for (const auto& candidate : scores) {
            if (!whole.model.has(candidate.effect->id()))
                continue;
            Rung trial;
            trial.added = candidate.effect->id();
            trial.predictedErrorDb = candidate.errorDb;
            trial.model = partOf(whole, rung.model, trial.added);
            if (trial.model.components.size() == whole.model.components.size()) {
                trial.model = whole.model;
                trial.fit = whole.fit;
                trial.comparison = *reached;
            } else {
                trial.fit = fitLinear(trial.model, whole.model, record, brief, part.part(0.4, 0.9));
                auto comparison = tryCompare(trial.model, record, {trial.fit.substeps, true}, progress.silent());
                if (!comparison)
                    continue;
                trial.comparison = std::move(*comparison);
            }
            if (next.added.empty() || trial.comparison.chiSquaredPerValue < next.comparison.chiSquaredPerValue)
                next = std::move(trial);
            if (next.comparison.chiSquaredPerValue < rung.comparison.chiSquaredPerValue)
                break;  // else another one may go first
        }
        if (next.added.empty())
            next = atRest(rung, scores, whole);
        rung.diagnosis = diagnosisOf(rung, next, scores, whole, besideUnknown);
        rungs.push_back(std::move(next));
    }
    return rungs;
}

}  // namespace excursion
