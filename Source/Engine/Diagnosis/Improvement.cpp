// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Improvement.h"

#include "Engine/Diagnosis/FindCoupling.h"
#include "Engine/Diagnosis/FitEffects.h"
#include "Engine/Diagnosis/RungsTo.h"
#include "Engine/Diagnosis/StepsByResponse.h"
#include "Engine/Diagnosis/FollowSections.h"
#include "Engine/Diagnosis/Sums.h"
#include "Engine/Diagnosis/Refine.h"
#include "Engine/Diagnosis/Trial.h"
#include "Engine/Diagnosis/Whole.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Error.h"
#include "Engine/Estimate/Coupling.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FitResponse.h"
#include "Engine/Loudspeaker/OutputError.h"
#include "Engine/Loudspeaker/Seen.h"
#include "Engine/Loudspeaker/ShownMotions.h"

#include <algorithm>
#include <utility>

namespace excursion {
namespace {

Model first(Record& record, const ImproveOptions& options, FitSummary& summary, const Progress& progress)
{
    return fitEffects(record, options.with, options.diagnose.fit, &summary, progress);
}

Model first(const Spectra& spectra, const ImproveOptions& options, FitSummary& summary, const Progress&)
{
    return fitEffects(spectra, options.with, &summary);
}

void tryOne(Model& model, const Record& record, const Effect& effect, const FitOptions& options,
            const Progress& progress)
{
    tryEffect(model, record, effect, options, progress);
}

void tryOne(Model& model, const Spectra& spectra, const Effect& effect, const FitOptions&, const Progress&)
{
    if (!addByResponse(model, effect, responsesOf(spectra)).usable())
        throw Error(Error::Kind::numerical,
                    "The effect \"" + effect.id() + "\" could not be fitted to the frequency response.");
}

/// The effects as they were added; the fit that follows makes the covariance anew.
void putInOrder(Model& model, const std::vector<std::string>& effects)
{
    const auto place = [&](const Component& c) { return std::find(effects.begin(), effects.end(), c.effect->id()); };
    std::stable_sort(model.components.begin() + 1, model.components.end(),
                     [&](const Component& a, const Component& b) { return place(a) < place(b); });
    model.covariance.resize(0, 0);
}

FitSummary settle(Model& model, Record& record, const FitOptions& options, const Progress& progress)
{
    return refineByNoise(model, record, options, progress);
}

FitSummary settle(Model& model, const Spectra& spectra, const FitOptions&, const Progress&)
{
    FitSummary summary;
    static_cast<SearchSummary&>(summary) = refineByResponse(model, responsesOf(spectra));
    return summary;
}

/// With as many steps a sample as the model was fitted with, which may be more than the noise of each line asks for.
Comparison compareAsFitted(const Rung& rung, const Record& record)
{
    return compare(rung.model, record, {rung.fit.substeps, true});
}

Comparison compareAsFitted(const Rung& rung, const Spectra& spectra) { return compare(rung.model, spectra); }

std::variant<Record, Spectra> dataOf(const PreparedTake& take)
{
    if (const auto* spectra = take.asResponses())
        return *spectra;
    return take.record();
}

Problem couplingProblem(double corner)
{
    const auto text = plainText(corner, 2);
    return {"coupling",
            std::nullopt,
            corner,
            "Hz",
            false,
            "The laws of the loudspeaker fit the take if all its inputs roll off below " + text
                + " Hz, as the coupling capacitors of a sound card do. It is corrected by that; write \"coupling\": "
                + text + " into measurement.json for the other commands."};
}

}  // namespace

Improvement::Improvement(PreparedTake take, const ImproveOptions& options, const Progress& progress)
    : take_(std::move(take)), options_(options)
{
    progress.at(0.0, "checking the take");
    const auto& report = take_.report();
    ladder_.problems = report.problems;
    if (take_.asResponses() || report.fitForUse()) {
        data_ = dataOf(take_);
    } else {
        ladder_.verdict = Verdict::badMeasurement;
        ladder_.sentence = report.verdict();
    }
}

void Improvement::begin(const Progress& progress)
{
    auto begun = *this;  // what is cancelled changes nothing
    begun.beginBehind(0.0, progress.part(0.0, 0.8));
    begun.beginUncoupled(progress.part(0.8, 1.0));
    *this = std::move(begun);
}

void Improvement::beginBehind(double coupling, const Progress& progress)
{
    if (!take_.report().fitForUse())
        throw Error(Error::Kind::data, "The take is not fit for use: " + take_.report().verdict());
    Rung rung;
    auto data = dataOf(take_);
    if (auto* record = std::get_if<Record>(&data))
        uncouple(*record, coupling);
    rung.model = std::visit([&](auto& d) { return first(d, options_, rung.fit, progress.part(0.0, 0.4)); }, data);
    rung = judged(std::move(rung), data, progress.part(0.4, 1.0));
    data_ = std::move(data);
    coupling_ = coupling;
    ladder_.problems = take_.report().problems;
    if (coupling > 0.0)
        ladder_.problems.push_back(couplingProblem(coupling));
    ladder_.rungs.clear();
    keep(std::move(rung));
}

bool Improvement::mayBeCoupled() const { return !(coupling_ > 0.0) && !(take_.measurement().coupling > 0.0); }

bool Improvement::beginUncoupled(const Progress& progress)
{
    const auto* record = std::get_if<Record>(&data_);
    if (!record || !mayBeCoupled() || ladder_.rungs.empty())
        return false;
    const auto& last = ladder_.rungs.back();
    const bool allIsFound = last.diagnosis.verdict == Verdict::unknownEffect;
    const auto* behind = allIsFound ? &last.model : nullptr;
    if (last.diagnosis.verdict == Verdict::missingEffect)
        if (const auto& named = last.diagnosis.ranking.front();
            named.confirmedChiSquaredPerValue > 0.0 && named.confirmedChiSquaredPerValue < nearNoise)
            behind = &named.model;
    if (!behind || behind->components.empty())
        return false;
    constexpr double halved = 0.5;
    const double corner = findCoupling(*behind, *record, options_.diagnose.fit, allIsFound ? halved : 0.0,
                                       progress.part(0.0, 0.3));
    if (corner > 0.0)
        beginBehind(corner, progress.part(0.3, 1.0));
    return corner > 0.0;
}

bool Improvement::addTogether(const Progress& progress)
{
    auto data = data_;
    auto [rungs, coupling] = std::visit([&](auto& d) { return together(d, progress.part(0.0, 0.8)); }, data);
    if (coupling > 0.0) {
        auto begun = *this;
        begun.beginBehind(coupling, progress.part(0.8, 0.8));
        begun.addTogether(progress.part(0.8, 1.0));
        *this = std::move(begun);
        return true;
    }
    if (rungs.empty())
        return false;
    const auto* record = std::get_if<Record>(&data);
    const bool followed = record && record->sectionsDrift;
    rungs.back() = judged(std::move(rungs.back()), data, progress.part(0.8, 1.0));
    if (record && record->sectionsDrift != followed)
        for (std::size_t n = 0; n + 1 < rungs.size(); ++n)
            rungs[n].comparison = compareAsFitted(rungs[n], *record);
    use(std::move(data), ladder_.rungs.size() - 1, progress.silent());  // the last one comes again, with its diagnosis
    for (auto& rung : rungs)
        keep(std::move(rung));
    return true;
}

Improvement::Together Improvement::together(const Spectra& spectra, const Progress& progress) const
{
    const auto& options = options_.diagnose;
    const auto steps = stepsByResponse(ladder_.model(), spectra, options.fit.threads, progress.part(0.0, 0.7));
    std::vector<Rung> rungs;
    for (std::size_t n = 0; n < steps.size(); ++n) {
        const double count = static_cast<double>(steps.size()), done = static_cast<double>(n);
        if (n == 0)
            rungs.push_back(ladder_.rungs.back());
        else
            rungs.back().diagnosis = diagnose(
                rungs.back().model, spectra, rungs.back().comparison, options,
                progress.part(0.7 + 0.3 * done / count, 0.7 + 0.3 * (done + 1.0) / count));
        auto& last = rungs.back();
        nameNext(last.diagnosis, last.model, spectra, last.comparison, steps[n]);
        const auto& named = last.diagnosis.ranking.front();
        Rung rung;
        rung.added = named.effect;
        rung.predictedErrorDb = named.predictedErrorDb;
        rung.model = named.model;  // the step's, or what leaves less
        auto order = last.model.effectIds();
        order.push_back(rung.added);
        putInOrder(rung.model, order);
        rung.fit = settle(rung.model, spectra, options.fit, {});
        rung.comparison = compare(rung.model, spectra);
        rungs.push_back(std::move(rung));
    }
    return {std::move(rungs), 0.0};
}

Improvement::Together Improvement::together(Record& record, const Progress& progress) const
{
    auto base = ladder_.rungs.back();
    const auto backed = std::count_if(base.diagnosis.ranking.begin(), base.diagnosis.ranking.end(),
                                      [](const RankedEffect& r) { return r.vote.backs(); });
    const bool oneIsKnown = base.diagnosis.verdict == Verdict::missingEffect;
    if (!hasPeriods(record) || base.diagnosis.verdict == Verdict::complete || (backed < 2 && oneIsKnown))
        return {};
    const auto whole = fitWhole(base.model, record, options_.diagnose.fit, mayBeCoupled(), progress.part(0.0, 0.6));
    if (whole.coupling > 0.0)
        return {{}, whole.coupling};
    const auto& named = base.diagnosis.ranking;
    if (whole.votes.empty() && whole.sectionsDrift && whole.fit.usable()) {  // nothing but these moves was missing
        record.sectionsDrift = true;
        base.model = whole.model;
        base.fit = whole.fit;
        base.comparison = compareAsFitted(base, record);
        return {{std::move(base)}, 0.0};
    }
    // One effect that is known is added by its own trial.
    if (whole.votes.empty()
        || (oneIsKnown && whole.votes.size() == 1 && whole.votes.begin()->first == named.front().effect))
        return {};
    if (whole.followsDrift)
        takeDriftOutOfNoise(record);
    record.sectionsDrift = record.sectionsDrift || whole.sectionsDrift;
    if (whole.followsDrift || whole.sectionsDrift)
        base.comparison = compare(base.model, record);
    auto rungs = rungsTo(whole, base, record, options_.diagnose, progress.part(0.6, 1.0));
    if (rungs.empty())
        return {};
    double reached = base.comparison.chiSquaredPerValue;
    if (oneIsKnown)  // the noise may be another one now
        if (const auto byItsTrial = tryCompare(named.front().model, record, {0, false}, progress.silent()))
            reached = std::min(reached, byItsTrial->chiSquaredPerValue);
    if (!(rungs.back().comparison.chiSquaredPerValue < reached))
        return {};
    return {std::move(rungs), 0.0};
}

void Improvement::add(const std::string& id, const Progress& progress)
{
    const auto& effect = effectNamed(id);
    const auto& last = ladder_.rungs.back();
    if (last.model.has(id))
        throw Error(Error::Kind::data, "The model already has the effect \"" + id + "\".");
    if (const auto why = whyUnseen(effect, std::visit([](const auto& d) { return seenIn(d); }, data_)); !why.empty())
        throw Error(Error::Kind::data, why);
    if (const auto why = whyHostMissing(effect, last.model); !why.empty())
        throw Error(Error::Kind::data, why);
    auto data = data_;
    Rung rung;
    rung.added = id;
    rung.model = last.model;
    const auto* ranked = last.diagnosis.find(id);
    if (ranked)
        rung.predictedErrorDb = ranked->predictedErrorDb;
    if (ranked && ranked->model.has(id))  // a trial that lowered nothing is not kept
        rung.model = ranked->model;
    else
        std::visit(
            [&](const auto& d) { tryOne(rung.model, d, effect, options_.diagnose.fit, progress.part(0.0, 0.25)); },
            data);
    rung.fit = std::visit(
        [&](auto& d) { return settle(rung.model, d, options_.diagnose.fit, progress.part(0.25, 0.5)); }, data);
    rung = judged(std::move(rung), data, progress.part(0.5, 1.0));
    use(std::move(data), ladder_.rungs.size(), progress.silent());
    keep(std::move(rung));
}

/// Compares and diagnoses all rungs anew where the noise is another, or sections are followed; one that runs away there
/// stays as it was.
void Improvement::use(Data data, std::size_t kept, const Progress& silent)
{
    auto rungs = ladder_.rungs;  // should the work fail, nothing has happened
    rungs.resize(kept);
    if (const auto* now = std::get_if<Record>(&data), *before = std::get_if<Record>(&data_);
        now && before
        && (noiseHoldsDrift(*now) != noiseHoldsDrift(*before) || now->sectionsDrift != before->sectionsDrift))
        for (auto& rung : rungs)
            if (auto comparison = tryCompare(rung.model, *now, {rung.fit.substeps, true}, silent)) {
                rung.comparison = std::move(*comparison);
                rung.diagnosis = diagnose(rung.model, *now, rung.comparison, options_.diagnose, silent);
                rung.diagnosis.problems = ladder_.problems;
            }
    ladder_.rungs = std::move(rungs);
    data_ = std::move(data);
}

/// Compares and diagnoses the rung's model. What no effect explains may be small moves between the sections of the
/// take, which the record has followed then.
Rung Improvement::judged(Rung rung, Data& data, const Progress& progress) const
{
    const auto judge = [&](const Progress& part) {
        rung.comparison = std::visit([&](const auto& d) { return compareAsFitted(rung, d); }, data);
        rung.diagnosis = std::visit(
            [&](const auto& d) { return diagnose(rung.model, d, rung.comparison, options_.diagnose, part); }, data);
    };
    judge(progress.part(0.0, 0.5));
    // Before something is called unknown the model is to be as good as it can be: fitted to what its simulation leaves.
    auto* record = std::get_if<Record>(&data);
    const bool isUnknown = record && rung.diagnosis.verdict == Verdict::unknownEffect && rung.fit.usable();
    if (!isUnknown)
        return rung;
    auto following = followingSections(rung.model, *record, rung.fit.substeps, progress);
    if (following) {
        record->sectionsDrift = true;
        rung.model = std::move(following->model);
        rung.fit = following->fit;
    }
    if (following || rung.fit.substeps == 0 || (record->noiseKnown && rung.fit.chiSquaredPerValue < nearNoise)) {
        auto better = rung.model;
        if (const auto run = fitBySimulation(better, *record, options_.diagnose.fit, true, progress.part(0.5, 0.7));
            run.usable()) {
            rung.model = std::move(better);
            rung.fit = run;
            judge(progress.part(0.7, 1.0));
        } else if (following) {
            judge(progress.part(0.7, 1.0));
        }
    }
    return rung;
}

void Improvement::keep(Rung rung)
{
    rung.diagnosis.problems = ladder_.problems;
    ladder_.rungs.push_back(std::move(rung));
    concludeFromLast();
}

void Improvement::concludeFromLast()
{
    auto diagnosis = ladder_.rungs.back().diagnosis;
    tell(diagnosis, ladder_.problems);
    ladder_.verdict = diagnosis.verdict;
    ladder_.sentence = (diagnosis.verdict == Verdict::unknownEffect ? foundInWords(ladder_) : std::string())
                       + diagnosis.sentence;
}

void Improvement::undo()
{
    if (ladder_.rungs.size() < 2)
        return;
    ladder_.rungs.pop_back();
    concludeFromLast();
}

std::vector<Waveform> Improvement::waveforms(int level) const
{
    const auto* record = std::get_if<Record>(&data_);
    if (!record || ladder_.rungs.empty())
        return {};
    return excursion::waveforms(ladder_.model(), *record, level);
}

}  // namespace excursion
