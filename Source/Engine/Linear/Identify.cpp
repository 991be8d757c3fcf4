// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/Identify.h"

#include "Engine/Error.h"
#include "Engine/Linear/Bilinear.h"
#include "Engine/Linear/LargeOrderStarts.h"
#include "Engine/Linear/LeastSection.h"
#include "Engine/Linear/Response.h"
#include "Engine/Linear/Subspace.h"
#include "Engine/Signal/Level.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr int cheapOrder = 20;            // up to here every start is tried, as it costs nothing
constexpr std::size_t largeSearches = 3;  // above it as many of the best are refined to the end
constexpr int prunedMore = 10;            // than twice the order: the model whose least sections are taken out

StateSpace subspaceAt(const FrequencyData& data, double rate, int order, bool stable)
{
    auto warped = data;
    for (auto& f : warped.frequency)
        f = warpedFrequency(f, rate);
    auto model = toContinuous(
        dynamicsOf(observabilityRange(warped, rate, blockRowsFor(order, data.lines())), order, data.inputs, stable));
    if (stable)
        model = mirrored(model);
    fitInputs(model, data);
    return model;
}

/// The same in lambda = s^alpha: z = (a + lambda)/(a - lambda), a = (2 rate)^alpha.
StateSpace subspaceAt(const FrequencyData& data, double rate, const IdentifyOptions& options)
{
    const double a = std::pow(2.0 * rate, options.alpha);
    const Eigen::VectorXcd lambda = evaluationPoints(data.frequency, 0.0, options.alpha);
    auto range = observabilityRange(data, (a + lambda.array()) / (a - lambda.array()),
                                    blockRowsFor(options.order, data.lines()));
    range.sampleRate = 0.5 * a;
    auto model = toContinuous(dynamicsOf(range, options.order, data.inputs, false));
    if (options.refinement.stable && data.inputs == 1) {
        const auto sections = mirrored(sectionsOf(poles(model), 0.0, sectionScaleOf(data, options), options.alpha));
        const auto fit = fitPartialFractions(sections, data);
        return realize(sections, fit.C, fit.D);
    }
    fitInputs(model, data, options.alpha);
    return model;
}

/// All models that the subspace method has to offer, up to the first that costs less than `enough`. Those whose
/// transform does not exist are left out.
std::vector<StateSpace> subspaceModels(const FrequencyData& data, const IdentifyOptions& options, double enough = 0.0)
{
    const bool stable = options.refinement.stable;
    if (options.sampleRate > 0.0)
        return {identifySubspace(data, options.sampleRate, options.order, stable)};
    std::vector<StateSpace> models;
    for (const double rate : warpingRates(data, options.thorough))
        try {
            models.push_back(options.alpha == 1.0 ? subspaceAt(data, rate, options.order, stable)
                                                  : subspaceAt(data, rate, options));
            if (enough > 0.0 && judged(models.back(), data, options.alpha).cost < enough)
                break;
        } catch (const Error& e) {
            if (e.kind() != Error::Kind::numerical)
                throw;
        }
    return models;
}

void add(std::vector<PoleStart>& candidates, const char* start, const SecondOrderSections& sections,
         const FrequencyData& data)
{
    if (!sections.factors.allFinite())
        return;
    auto fit = fitPartialFractions(sections, data);
    if (std::isfinite(fit.cost))
        candidates.push_back({start, std::move(fit)});
}

SecondOrderSections fittedVectors(SecondOrderSections sections, const FrequencyData& data, int times)
{
    for (int k = 0; k < times && sections.factors.allFinite(); ++k)
        sections = relocatePoles(sections, data);
    return sections;
}

/// What is pruned to an order: a larger one by whole pairs, as the lines tell it; without enough of them hardly larger,
/// or none at all.
int largerOrder(int order, const FrequencyData& data)
{
    const auto larger = static_cast<int>(std::min<Index>(2 * order + prunedMore, data.lines() / 8));
    return larger + ((larger - order) % 2 != 0 ? 1 : 0);
}

/// The poles of a larger model, its least sections taken out one after the other.
SecondOrderSections prunedTo(int order, const FrequencyData& data, const IdentifyOptions& options, double scale)
{
    auto larger = options;
    larger.order = largerOrder(order, data);
    double best = std::numeric_limits<double>::infinity();
    PartialFractionFit fit;
    for (const auto& model : subspaceModels(data, larger)) {
        auto candidate = fitPartialFractions(sectionsOf(poles(model), options.sampleRate, scale, options.alpha), data);
        if (candidate.cost < best) {
            best = candidate.cost;
            fit = std::move(candidate);
        }
    }
    auto quick = options.refinement;
    quick.maximumIterations = 4;
    while (fit.sections.order() >= order + 2) {
        fit = fitPartialFractions(withoutLeast(fit, data, false), data);
        if (isStable(fit.sections))
            fit = refinePoles(fit.sections, data, quick).fit;
    }
    return fit.sections;
}

/// Every start that there is, the others left out where the subspace method costs less than `floor`.
std::vector<PoleStart> allStarts(const FrequencyData& data, const IdentifyOptions& options, double floor,
                                 const Progress& progress)
{
    progress.at(0.0, "identifying by subspace");
    const double scale = sectionScaleOf(data, options);
    std::vector<PoleStart> starts;
    for (const auto& model : subspaceModels(data, options))
        add(starts, "subspace", sectionsOf(poles(model), options.sampleRate, scale, options.alpha), data);
    for (const auto& start : starts)
        if (start.fit.cost < floor)
            return starts;
    progress.at(0.2, "fitting vectors");
    for (const bool logarithmic : {false, true})
        add(starts, "vector fitting",
            fittedVectors(spreadPoles(options.order, data, options.sampleRate, scale, logarithmic, options.alpha), data,
                          10),
            data);
    if (options.thorough && options.order >= 2 && largerOrder(options.order, data) >= options.order + 2) {
        progress.at(0.4, "pruning a larger model");
        add(starts, "pruned", prunedTo(options.order, data, options, scale), data);
    }
    return starts;
}

LinearIdentification fromFit(const PartialFractionFit& fit, const FrequencyData& data)
{
    auto result = judged(realize(fit.sections, fit.C, fit.D), data, fit.sections.alpha);
    result.sections = fit.sections;
    result.cost = fit.cost;
    return result;
}

}  // namespace

LinearIdentification judged(StateSpace model, const FrequencyData& data, double alpha)
{
    LinearIdentification result;
    const Resolvent resolvent(model);
    const MatrixXd weights = weightsOf(data);
    double error = 0.0, power = 0.0, weightedError = 0.0, weightedPower = 0.0, chiSquared = 0.0;
    for (Index k = 0; k < data.lines(); ++k) {
        const Eigen::MatrixXcd response = resolvent.response(
            evaluationPoint(data.frequency[static_cast<std::size_t>(k)], model.sampleRate, alpha));
        for (Index e = 0; e < data.value.cols(); ++e) {
            const double d = std::norm(response(e % data.outputs, e / data.outputs) - data.value(k, e));
            error += d;
            power += std::norm(data.value(k, e));
            weightedError += d * weights(k, e) * weights(k, e);
            weightedPower += std::norm(data.value(k, e)) * weights(k, e) * weights(k, e);
            if (data.deviation.size() != 0)
                chiSquared += d / (data.deviation(k, e) * data.deviation(k, e));
        }
    }
    result.cost = weightedError / weightedPower;
    result.errorDb = decibelsOf(error / power);
    result.chiSquared = data.deviation.size() != 0 ? chiSquared : std::numeric_limits<double>::quiet_NaN();
    result.stable = alpha == 1.0 ? isStable(model) : isStable(sectionsOf(poles(model), 0.0, 1.0, alpha));
    result.model = std::move(model);
    return result;
}

LinearIdentification identify(const FrequencyData& data, const IdentifyOptions& options, const Progress& progress)
{
    requireFitting(options, data, "The frequency response cannot be identified");
    if (2 * data.lines() * data.outputs < 2 * options.order + 1 || options.order >= data.lines())
        throw Error(Error::Kind::data, "A model of order " + std::to_string(options.order) + " needs more than the "
                                           + std::to_string(data.lines()) + " lines of the frequency response.");
    // Where the subspace model meets the noise, there is nothing left to be found by other starts.
    const MatrixXd weights = weightsOf(data);
    const double floor = data.deviation.size() == 0 ? 1e-20
                                                    : 1.1 * weights.cwiseProduct(data.deviation).squaredNorm()
                                                          / weights.cwiseProduct(data.value.cwiseAbs()).squaredNorm();
    if (data.inputs > 1 || !options.refine) {
        progress.at(0.0, "identifying by subspace");
        LinearIdentification best;
        best.cost = std::numeric_limits<double>::infinity();
        for (const auto& model : subspaceModels(data, options, options.order > cheapOrder ? floor : 0.0))
            if (auto found = judged(model, data, options.alpha); found.cost < best.cost)
                best = std::move(found);
        if (!std::isfinite(best.cost))
            throw Error(Error::Kind::numerical,
                        "The subspace method found no model of order " + std::to_string(options.order) + ".");
        best.start = "subspace";
        best.refinement.end(options.refine ? Termination::severalInputs : Termination::notAsked);
        return best;
    }

    const bool large = options.order > cheapOrder;
    auto candidates = large ? startsOfLargeOrder(data, options, floor, progress.part(0.0, 0.5))
                            : allStarts(data, options, floor, progress);
    if (candidates.empty())
        throw Error(Error::Kind::numerical, "No start gave a model of order " + std::to_string(options.order) + ".");
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const auto& a, const auto& b) { return a.fit.cost < b.fit.cost; });
    const auto& leading = candidates.front().fit;
    const bool met = large ? explainsAllButNoise(leading, data, floor) : leading.cost < floor;
    const std::size_t searches = met ? 1 : !options.thorough ? 2 : large ? largeSearches : candidates.size();
    if (candidates.size() > searches)
        candidates.resize(searches);

    LinearIdentification best;
    best.cost = std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < candidates.size(); ++c) {
        auto start = candidates[c].fit.sections;
        if (options.refinement.stable)
            start = mirrored(start);
        const double share = static_cast<double>(candidates.size());
        const auto refined = refinePoles(
            start, data, options.refinement,
            progress.part(0.5 + 0.5 * static_cast<double>(c) / share, 0.5 + 0.5 * static_cast<double>(c + 1) / share));
        if (refined.fit.cost < best.cost) {
            best = fromFit(refined.fit, data);
            best.start = candidates[c].name;
            best.refinement = refined;
        }
    }
    if (!std::isfinite(best.cost))
        throw Error(Error::Kind::numerical,
                    "No search for a model of order " + std::to_string(options.order) + " ended in finite numbers.");
    return best;
}

}  // namespace excursion
