// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Trial.h"

#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/RaiseDegrees.h"
#include "Engine/Loudspeaker/FeedbackError.h"
#include "Engine/Loudspeaker/OutputError.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace excursion {
namespace {

/// The cost of a model that leaves this, infinite where it runs away.
double costOf(const Model& model, const std::vector<SectionFit>& fits)
{
    auto sum = sumOf(fits);
    if (!sum)
        return std::numeric_limits<double>::infinity();
    addPrior(model, freeParameters(model), *sum);
    return sum->cost;
}

OutputErrorOptions withoutGradient(const FitOptions& options)
{
    OutputErrorOptions run;
    run.gradient = false;
    run.played = options.fedGradient;
    run.substeps = options.substeps;
    run.threads = options.threads;
    return run;
}

double quickCost(const Model& model, const Record& record, const std::vector<std::size_t>& sections,
                 const FitOptions& options)
{
    return costOf(model, quickError(model, record, sections, {}, withoutGradient(options)));
}

/// Whether laws of a higher degree leave so much less that it pays for their coefficients: what the slopes of fed laws
/// promise need not come.
bool paysForItself(const Model& higher, const Model& model, const Record& record,
                   const std::vector<std::size_t>& sections, const FitOptions& options)
{
    const auto left = [&](const Model& of) {
        return sumOf(quickError(of, record, sections, {}, withoutGradient(options)));
    };
    const auto now = left(model), then = left(higher);
    if (!now || !then)
        return then.has_value();
    const double unit = std::max(1.0, then->cost / std::max(1.0, then->rows)),
                 more = static_cast<double>(freeParameters(higher).size())
                        - static_cast<double>(freeParameters(model).size());
    return now->cost - then->cost > priceOfCoefficient * unit * more;
}

/// Takes back what laws were raised by, where that no longer pays. The last fit, if there was one.
std::optional<FitSummary> lowerAsItPays(Model& model, const Record& record, const std::vector<std::size_t>& sections,
                                        const FitOptions& options, const Progress& progress)
{
    std::optional<FitSummary> last;
    for (const auto k : tooHigh(model)) {
        constexpr int by = 4;
        auto lower = withDegree(model, k, model.components[k].operatingRange.degree - by);
        const auto next = fitFed(lower, record, sections, options, progress);
        if (!next.usable() || paysForItself(model, lower, record, sections, options))
            continue;
        model = std::move(lower);
        last = next;
    }
    return last;
}

/// The strengths of the newest component times a factor.
Model newestScaled(Model model, double factor)
{
    model.components.back() = scaled(std::move(model.components.back()), factor);
    return model;
}

/// The newest component with the largest share of its step that leaves less: the whole may be too long for the
/// simulation. None where no share does.
std::optional<Model> largestShare(const Model& model, const std::function<bool(const Model&)>& leavesLess)
{
    for (const double share : {1.0, 0.5, 0.2, 0.05})
        if (auto candidate = newestScaled(model, share); leavesLess(candidate))
            return candidate;
    return std::nullopt;
}

/// Shapes of a linear effect that are next to nothing, but not from the start, at a share of where they start. Whether
/// there are any.
bool wakeShapesOf(Component& component)
{
    constexpr double nothing = 0.05, share = 0.15;
    bool any = false;
    if (!component.effect->linear() || !isAtWork(component))
        return any;
    const auto usual = component.effect->parameters(component.operatingRange);
    for (std::size_t k = 0; k < usual.size(); ++k) {
        auto& p = component.parameters[k];
        if (p.strength || !p.free || !std::isfinite(p.prior)
            || !(std::abs(p.value) < nothing * std::abs(usual[k].value)))
            continue;
        p.value = share * usual[k].value;
        any = true;
    }
    return any;
}

/// Whether a cost is less than a share of the lowest one; it is the lowest one then.
bool falls(double& lowest, double cost, double share)
{
    const bool does = cost < share * lowest;
    if (does)
        lowest = cost;
    return does;
}

/// Changes one component after the other, on trial. Whether a change was kept.
/// @param change  of component k; false if there is nothing to change
bool changeEach(Model& model, const std::function<bool(Model& anew, std::size_t k)>& change,
                const std::function<bool(Model& anew)>& keeps)
{
    bool any = false;
    for (std::size_t k = 1; k < model.components.size(); ++k) {
        auto anew = model;
        if (!change(anew, k) || !keeps(anew))
            continue;
        model = std::move(anew);
        any = true;
    }
    return any;
}

}  // namespace

void chooseResiduals(FitOptions& fit, ScoreOptions& score, const Model& model, const Record& record,
                     const std::vector<std::size_t>& sections)
{
    if (fit.substeps == 0)
        fit.substeps = substepsFor(model, record, fit.simulationTolerance);
    score.substeps = fit.substeps;
    fit.fedGradient = score.played = isBetterPlayed(model, record, sections, withoutGradient(fit));
}

FitSummary quickFit(Model& model, const Record& record, const std::vector<std::size_t>& sections,
                    const FitOptions& options, const Progress& progress)
{
    auto fed = options;
    fed.fed = true;
    fed.fedGradient = false;
    if (!options.fedGradient)
        return fit(model, record, sections, fed, progress);
    // While fed laws leave much more than a simulation their fit goes astray.
    constexpr double astray = 3.0;
    const double now = quickCost(model, record, sections, options);
    if (auto found = model; quickCost(model, record, sections, fed) < astray * now
                            && fit(found, record, sections, fed, progress.part(0.0, 0.2)).usable()
                            && quickCost(found, record, sections, options) < now)
        model = std::move(found);
    auto played = options;
    played.fed = false;
    return fit(model, record, sections, played, progress.part(0.2, 1.0));
}

/// Fed laws never run away: a law that leaves the coil no inductance looks like any other.
bool canBeSimulated(const Model& model, const Record& record, const std::vector<std::size_t>& sections,
                    const FitOptions& options)
{
    return std::isfinite(costOf(model, outputError(model, record, sections, {}, withoutGradient(options))));
}

FitSummary fitFed(Model& model, const Record& record, const std::vector<std::size_t>& sections, FitOptions options,
                  const Progress& progress)
{
    auto found = model;
    auto summary = quickFit(found, record, sections, options, progress);
    options.fed = false;
    if (hasPeriods(record) && !(summary.usable() && canBeSimulated(found, record, sections, options)))
        return fit(model, record, sections, options, progress);
    model = std::move(found);
    return summary;
}

bool helps(const Score& proposed, const Record& record, const std::vector<std::size_t>& sections,
           const FitOptions& options)
{
    const auto left = [&](const Model& candidate) { return quickCost(candidate, record, sections, options); };
    const double still = left(newestScaled(proposed.model, 0.0));
    return (!proposed.byResponse.components.empty() && left(proposed.byResponse) < still)
           || largestShare(proposed.model, [&](const Model& candidate) { return left(candidate) < still; });
}

FitSummary tryFit(Model& model, const Score& proposed, const Record& record, const std::vector<std::size_t>& sections,
                  const FitOptions& options, const Progress& progress)
{
    model = proposed.model;
    FitOptions chosen = options;
    if (chosen.substeps == 0)
        chosen.substeps = substepsFor(model, record, options.simulationTolerance);
    const auto left = [&](const Model& candidate) { return quickCost(candidate, record, sections, chosen); };
    const bool simulated = chosen.fedGradient || !hasPeriods(record);  // what left() tells
    Model best = newestScaled(model, 0.0);
    double lowest = left(best);
    const auto shortened = largestShare(model, [&](const Model& candidate) {
        const double cost = left(candidate);
        const bool does = cost < lowest && (simulated || canBeSimulated(candidate, record, sections, chosen));
        if (does)
            lowest = cost;
        return does;
    });
    if (shortened)
        best = *shortened;
    // A linear effect shows in the frequency response alone; in time it would creep along the curved valley in which
    // relaxations trade off against the stiffness. Beside laws the responses tell no more than where that valley is, so
    // what they say may leave a little more at first.
    constexpr double near = 2.0, worthIt = 0.8;
    if (!proposed.byResponse.components.empty() && left(proposed.byResponse) < near * lowest) {
        model = proposed.byResponse;
        auto summary = fitFed(model, record, sections, chosen, progress);
        if (summary.usable() && left(model) < worthIt * lowest)
            return summary;
    }
    model = std::move(best);
    return fitFed(model, record, sections, chosen, progress);
}

FitSummary fitBySimulation(Model& model, const Record& record, const FitOptions& options, bool toTheEnd,
                           const Progress& progress)
{
    const auto sections = estimationSections(record);
    constexpr double clean = 1.2;
    const auto near = [&](const FitSummary& s) {
        return s.usable() && !(record.noiseKnown && s.chiSquaredPerValue > nearNoise);
    };
    const auto run = [&](const LeastSquaresOptions& search, bool fedGradient, bool bent, double from, double to) {
        auto chosen = options;
        chosen.search = search;
        chosen.bent = bent;
        chosen.fedGradient = fedGradient && hasPeriods(record);
        chosen.exactGradient = !fedGradient;
        return fit(model, record, sections, chosen, progress.part(from, to));
    };
    const auto stage = [&](int iterations, double tolerance, bool fedGradient, double from, double to) {
        // the last digits lie along valleys
        return run({iterations, tolerance}, fedGradient, fedGradient && tolerance < 1e-4, from, to);
    };
    auto summary = stage(15, 1e-3, true, 0.0, 0.2);
    if (summary.usable() && !near(summary))  // where laws rule the motion the slopes of fed ones may lead nowhere
        summary = stage(15, 1e-3, false, 0.2, 0.3);
    if (!near(summary))
        return summary;
    // The last word has the simulation's own slopes, of which come the standard errors, too. At the noise those of fed
    // laws lead no further.
    const auto onlyNoise = [&] { return near(summary) && summary.onlyNoise && summary.chiSquaredPerValue < clean; };
    if (!onlyNoise())
        summary = stage(20, 5e-7, true, 0.3, 0.5);
    constexpr LeastSquaresOptions alongTheFloor {.maximumIterations = 4, .costTolerance = 1e-5, .firstDamping = 1e-7};
    if (onlyNoise())
        return run(alongTheFloor, false, true, 0.5, 1.0);
    if (!record.noiseKnown)
        return stage(options.search.maximumIterations, options.search.costTolerance, false, 0.5, 1.0);
    return toTheEnd ? stage(30, 1e-4, false, 0.5, 1.0) : stage(15, 1e-3, false, 0.5, 1.0);
}

bool findAnew(Model& model, const LinearResponses& still, const std::function<bool(const Component&)>& which,
              const std::function<bool(Model& anew)>& keeps)
{
    return changeEach(
        model,
        [&](Model& anew, std::size_t k) {
            const auto& component = anew.components[k];
            return component.effect->linear() && which(component)
                   && fitByResponse(anew, k, still.gridFor(component)).usable();
        },
        keeps);
}

bool wakeShapes(Model& model, const Record& record, const std::vector<std::size_t>& sections, const FitOptions& options)
{
    constexpr double worthIt = 0.998;
    double now = std::numeric_limits<double>::infinity();
    return changeEach(
        model,
        [&](Model& anew, std::size_t k) {
            const bool any = wakeShapesOf(anew.components[k]);
            if (any && std::isinf(now))
                now = quickCost(model, record, sections, options);
            return any;
        },
        [&](Model& anew) {
            return quickFit(anew, record, sections, options).usable()
                   && falls(now, quickCost(anew, record, sections, options), worthIt);
        });
}

bool findPartsAnew(Model& model, const Record& record, const std::vector<std::size_t>& sections,
                   const FitOptions& options)
{
    if (!hasPeriods(record))
        return false;
    // What is really there shows at once: the responses have told its shape.
    constexpr double worthIt = 0.95;
    auto glance = options;
    glance.search = {3, 1e-2};
    const bool woken = wakeShapes(model, record, sections, options);
    double now = quickCost(model, record, sections, options);
    return findAnew(
               model, LinearResponses(withoutLaws(model, record, options.threads)),
               [](const Component& component) { return !component.effect->parts(component.operatingRange).empty(); },
               [&](Model& anew) {
                   if (!quickFit(anew, record, sections, glance).usable()
                       || quickCost(anew, record, sections, options) > now
                       || !quickFit(anew, record, sections, options).usable())
                       return false;
                   return falls(now, quickCost(anew, record, sections, options), worthIt);
               })
           || woken;
}

std::optional<FitSummary> raiseAsItPays(Model& model, const Record& record, const std::vector<std::size_t>& sections,
                                        const FitOptions& options, const ScoreOptions& score, double share,
                                        const Progress& progress)
{
    std::optional<FitSummary> last;
    constexpr int mostRaises = 3;
    for (int n = 0; n < mostRaises; ++n) {
        auto higher = model;
        if (raiseDegrees(higher, record, score, share).empty())
            break;
        const auto part = progress.part(static_cast<double>(n) / mostRaises, (n + 1.0) / mostRaises);
        const auto next = fitFed(higher, record, sections, options, part);
        if (!next.usable() || !paysForItself(higher, model, record, sections, options))
            break;
        model = std::move(higher);
        last = next;
    }
    return last;
}

FitSummary tryEffect(Model& model, const Record& record, const Effect& effect, const FitOptions& options,
                     const Progress& progress)
{
    ScoreOptions test;
    test.substeps = substepsFor(model, record, options.simulationTolerance);
    test.threads = options.threads;
    const auto scores = score(model, record, test, progress.part(0.0, 0.4)).scores;
    const auto start = std::find_if(scores.begin(), scores.end(), [&](const Score& s) { return s.effect == &effect; });
    if (start == scores.end())
        throw Error(Error::Kind::data, "This take cannot say anything about the effect \"" + effect.id()
                                           + "\" besides those that the model has.");
    FitOptions quick = options;
    quick.substeps = test.substeps;
    quick.search = {10, 3e-3};
    return tryFit(model, *start, record, trialSections(record, 2), quick, progress.part(0.4, 1.0));
}

FitSummary refine(Model& model, const Record& record, const FitOptions& options, const Progress& progress)
{
    FitOptions chosen = options;
    if (chosen.substeps == 0)
        chosen.substeps = substepsFor(model, record, options.simulationTolerance);
    const auto sections = estimationSections(record);
    ScoreOptions score;
    score.threads = chosen.threads;
    FitOptions quick = chosen;
    quick.search = {8, 1e-3};
    chooseResiduals(quick, score, model, record, sections);
    auto summary = fitFed(model, record, sections, quick, progress.part(0.0, 0.3));
    if (!quick.fedGradient)
        chooseResiduals(quick, score, model, record, sections);
    if (const auto raised = raiseAsItPays(model, record, sections, quick, score, 0.0, progress.part(0.3, 0.75)))
        summary = *raised;
    if (hasPeriods(record)) {
        if (record.noiseKnown && (summary.chiSquaredPerValue > atNoise || !summary.onlyNoise))
            findPartsAnew(model, record, sections, quick);
        else
            wakeShapes(model, record, sections, quick);
        quick.search = {15, 1e-4};
        if (!quick.fedGradient)
            summary = fitFed(model, record, sections, quick, progress.part(0.6, 0.75));
        // While more is missing a simulation tells little more than laws that are fed.
        if (record.noiseKnown && summary.chiSquaredPerValue > nearNoise && !quick.fedGradient)
            return summary;
    }
    const auto lower = [&](const Progress& part) {
        chooseResiduals(quick, score, model, record, sections);
        return lowerAsItPays(model, record, sections, quick, part).has_value();
    };
    // The last fit is dear, so it should have the coefficients that stay. A lower law is compared with one that was
    // fitted as long.
    if (summary.onlyNoise && summary.chiSquaredPerValue < atNoise && !tooHigh(model).empty()
        && fitFed(model, record, sections, quick, progress.part(0.75, 0.76)).usable())
        lower(progress.part(0.76, 0.77));
    summary = fitBySimulation(model, record, chosen, false, progress.part(0.77, 0.95));
    if (!tooHigh(model).empty() && lower(progress.part(0.95, 0.97)))
        summary = fitBySimulation(model, record, chosen, false, progress.part(0.97, 1.0));
    return summary;
}

FitSummary refineByNoise(Model& model, Record& record, const FitOptions& options, const Progress& progress)
{
    if (warms(model))
        useSilentNoise(record);
    const auto summary = refine(model, record, options, progress.part(0.0, 0.6));
    if (!summary.usable() || !followsDrift(model, record))
        return summary;
    useSilentNoise(record);
    auto again = model;
    auto next = refine(again, record, options, progress.part(0.6, 1.0));
    if (!next.usable())
        return summary;
    model = std::move(again);
    return next;
}

}  // namespace excursion
