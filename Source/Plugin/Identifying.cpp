// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Identifying.h"

#include "Engine/Document/Engineering.h"
#include "Engine/Error.h"
#include "Engine/Fractional/FractionalIdentify.h"
#include "Engine/Fractional/FractionalReduction.h"
#include "Engine/Fractional/FractionalStabilization.h"
#include "Engine/Fractional/FractionalStateSpaceFile.h"
#include "Engine/Linear/OrderSweep.h"
#include "Engine/Linear/PoleZeroReduction.h"
#include "Engine/Linear/Reduction.h"
#include "Engine/Linear/Response.h"
#include "Engine/Linear/StateSpaceFile.h"
#include "Engine/Signal/Level.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <numbers>
#include <numeric>

namespace excursion::plugin {
namespace {

bool fractional(const Identified& one)
{
    return one.asked.time == ModelTime::fractional || one.asked.time == ModelTime::fractionalFree;
}

std::vector<int> ordersOf(const IdentifyWish& wish)
{
    if (wish.order > 0)
        return {wish.order};
    std::vector<int> all(8);
    std::iota(all.begin(), all.end(), 1);
    return all;
}

/// Responses, errors and stability of the model as it is.
void judge(Identified& one)
{
    const auto& frequency = one.data.frequency;
    const auto values = fractional(one) ? respond(FractionalStateSpace {one.alpha, one.model}, frequency)
                                        : respond(one.model, frequency);
    FrequencyData own {frequency, Eigen::MatrixXcd(static_cast<Eigen::Index>(values.size()), 1), {}, 1, 1};
    for (std::size_t k = 0; k < values.size(); ++k)
        own.value(static_cast<Eigen::Index>(k), 0) = values[k](0, 0);
    own = delayed(std::move(own), -one.delay);
    one.shown = {frequency, {own.value.data(), own.value.data() + own.value.size()}, {}, {}};
    const auto judged = excursion::judged(one.model, delayed(one.data, one.delay), one.alpha);
    one.errorDb = judged.errorDb;
    one.stable = judged.stable;
}

void identifyWhole(Identified& one, const Progress& progress)
{
    OrderSweepOptions sweeping;
    sweeping.orders = ordersOf(one.asked);
    sweeping.identify.sampleRate = one.asked.time == ModelTime::discrete ? one.response.sampleRate : 0.0;
    sweeping.identify.refinement.stable = !one.asked.unstable;
    const auto sweep = sweepOrders(one.data, sweeping, nullptr, progress);
    one.base = sweep.entries[sweep.chosen].found.model;
    if (sweep.entries.size() < 2)
        return;
    one.sentence = sweep.sentence;
    for (const auto& entry : sweep.entries) {
        one.orders.order.push_back(entry.order);
        one.orders.error.push_back(entry.found.errorDb);
        one.orders.weighted.push_back(decibelsOf(entry.found.cost));
    }
}

void identifyFractional(Identified& one, const Progress& progress)
{
    FractionalOptions options;
    if (one.asked.time == ModelTime::fractional)
        options.alpha = one.asked.alpha;
    const auto sweep = sweepFractional(one.data, ordersOf(one.asked), options, progress);
    const auto& chosen = sweep.entries[sweep.chosen].found;
    one.base = chosen.model.form;
    one.alpha = chosen.model.alpha;
    one.alphaStandardError = chosen.alphaStandardError;
    one.sentence = chosen.warning;
    if (sweep.entries.size() < 2)
        return;
    one.sentence = sweep.sentence + (sweep.warning.empty() ? "" : " " + sweep.warning);
    for (const auto& entry : sweep.entries) {
        one.orders.order.push_back(entry.order);
        one.orders.error.push_back(entry.found.errorDb);
        one.orders.weighted.push_back(decibelsOf(entry.found.cost));
    }
}

std::string told(const std::string& reason) { return " It ended: " + reason + "."; }

void stabilize(Identified& one, const Progress& progress)
{
    StabilizeOptions options;
    options.method = *one.shape.stabilizing;
    options.alpha = one.alpha;
    if (fractional(one)) {
        auto done = stabilized(FractionalStateSpace {one.alpha, one.model}, one.data, options, progress);
        one.model = std::move(done.model.form);
        one.sentence += told(done.reason);
        return;
    }
    auto done = stabilized(one.model, one.data, options, progress);
    one.model = std::move(done.model);
    one.delay = done.delay;
    one.sentence += told(done.reason);
}

void reduce(Identified& one, const Progress& progress)
{
    const int order = one.shape.order;
    if (one.shape.reducing == Reducing::balanced) {
        if (fractional(one))
            throw Error(Error::Kind::data, "A model of fractional order has no Gramians to balance it by; prune it, or "
                                           "take out poles and zeros.");
        const auto all = balanced(one.model);
        one.model = truncated(all, order, Truncation::direct);
        return;
    }
    if (one.shape.reducing == Reducing::pruned) {
        PruningOptions options;
        options.order = order;
        const double scale = one.model.continuous()
                                 ? std::pow(2.0 * std::numbers::pi * one.data.frequency.back(), one.alpha)
                                 : 1.0;
        if (!judged(one.model, one.data, one.alpha).stable)
            throw Error(Error::Kind::data, "Only stable models are pruned; stabilize it first.");
        const auto data = delayed(one.data, one.delay);
        const auto done = prune(
            fitPartialFractions(sectionsOf(poles(one.model), one.model.sampleRate, scale, one.alpha), data), data,
            options, progress);
        one.model = realize(done.fit.sections, done.fit.C, done.fit.D);
        one.sentence += told(done.reason);
        return;
    }
    PoleZeroReductionOptions options;
    options.order = order;
    options.alpha = one.alpha;
    options.rippleDb = 60.0;  // as much as that order takes
    options.low = one.data.frequency.front();
    options.high = one.data.frequency.back();
    auto done = reduceByPolesAndZeros(one.model, options);
    one.model = std::move(done.model);
    one.delay += done.delay;
    one.sentence += told(done.reason);
}

}  // namespace

Identified identifiedOf(const PreparedTake& take, const IdentifyWish& wish, const std::string& name,
                        const Progress& progress)
{
    Identified one;
    one.asked = wish;
    one.name = name;
    progress.at(0.0, "estimating the response");
    one.response = responseOf(take, wish.ports);
    if (wish.time == ModelTime::discrete && one.response.sampleRate == 0.0)
        throw Error(Error::Kind::data, "A frequency response has no sample rate; choose a model of continuous time.");
    one.data = frequencyDataOf(one.response.frf);
    if (fractional(one))
        identifyFractional(one, progress);
    else
        identifyWhole(one, progress);
    one.model = one.base;
    judge(one);
    return one;
}

Identified shapedOf(const Identified& from, const ShapeWish& wish, const Progress& progress)
{
    auto one = from;
    one.shape = wish;
    one.model = one.base;
    one.delay = 0.0;
    one.sentence.clear();
    if (wish.stabilizing) {
        progress.at(0.0, "stabilizing");
        stabilize(one, progress.part(0.0, 0.5));
    }
    if (wish.reducing != Reducing::none) {
        progress.at(0.5, "reducing");
        reduce(one, progress.part(0.5, 1.0));
    }
    judge(one);
    return one;
}

std::string shortWordsOf(const Identified& one)
{
    auto text = "Order " + std::to_string(one.model.order()) + ", error " + decibels(one.errorDb)
                + (one.stable ? ", stable" : ", not stable");
    if (fractional(one)) {
        text += ", \u03b1 "
                + (one.alphaStandardError > 0.0 ? withError(one.alpha, one.alphaStandardError, "")
                                                : engineering(one.alpha, "", 3));
    }
    if (one.delay != 0.0)
        text += ", " + engineering(std::abs(one.delay), "s", 3) + (one.delay > 0.0 ? " late" : " early");
    return text + ".";
}

std::string wordsOf(const Identified& one)
{
    const auto from = one.sentence.find_first_not_of(' ');
    return shortWordsOf(one) + (from == std::string::npos ? "" : " " + one.sentence.substr(from));
}

nlohmann::ordered_json documentOf(const Identified& one)
{
    const std::vector<std::string> inputs {std::string(name(one.response.input))},
        outputs {std::string(name(one.response.output))};
    if (fractional(one))
        return toJson(NamedFractionalStateSpace {one.name, inputs, outputs, {one.alpha, one.model}});
    return toJson(NamedStateSpace {one.name, inputs, outputs, one.model, one.delay});
}

}  // namespace excursion::plugin
