// SPDX-License-Identifier: GPL-3.0-or-later
// The classes that know no loudspeaker.
#include "Engine/Ranking/ModelClasses.h"

#include "Engine/Error.h"
#include "Engine/GreyBox/MixedImpedance.h"
#include "Engine/GreyBox/MixedOrderPnlss.h"
#include "Engine/Linear/Identify.h"
#include "Engine/Linear/Simulation.h"
#include "Engine/Linear/StateSpaceFile.h"
#include "Engine/Polynomial/Block/BlockModelFile.h"
#include "Engine/Polynomial/Block/BlockModelFit.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalPnlssFile.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalPnlssFit.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalRecursion.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalSimulation.h"
#include "Engine/Polynomial/Hammerstein/HammersteinFit.h"
#include "Engine/Polynomial/Hammerstein/ParallelHammersteinFile.h"
#include "Engine/Polynomial/Narx/NarxFile.h"
#include "Engine/Polynomial/Narx/NarxFit.h"
#include "Engine/Polynomial/Narx/NarxRecursion.h"
#include "Engine/Polynomial/Pnlss/LinearStarts.h"
#include "Engine/Polynomial/Pnlss/PnlssFile.h"
#include "Engine/Polynomial/Pnlss/PnlssFit.h"
#include "Engine/Polynomial/Pnlss/Recursion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace excursion {
namespace {

constexpr double ringingSeconds = 0.1;
constexpr Eigen::Index mostTaps = 262144;  // of all branches of a Hammerstein model

std::string ofOrder(const char* words, Eigen::Index order, int degree)
{
    return std::string(words) + "order " + std::to_string(order)
           + (degree > 1 ? ", degree " + std::to_string(degree) : "");
}

std::string withAlpha(double alpha)
{
    std::array<char, 32> text {};
    std::snprintf(text.data(), text.size(), ", alpha %.3f", alpha);
    return text.data();
}

/// The document of a model, named after its class.
template <class Model>
nlohmann::ordered_json documentOf(const RankedTake& data, const char* of, const Model& model)
{
    return toJson(
        Named<Model> {of, std::string(name(data.input.quantity)), std::string(name(data.output.quantity)), model});
}

/// A driver's coil of fractional order beside a resonance, monomials at zero.
FractionalPnlss fractionalStart(const RankedTake& data, int degree)
{
    if (data.input.quantity != Quantity::voltage || data.output.quantity != Quantity::current)
        throw Error(Error::Kind::data, "The class is one of a current under a voltage.");
    auto impedance = data.response;
    for (Eigen::Index k = 0; k < impedance.lines(); ++k) {
        const auto Y = impedance.value(k, 0);
        if (impedance.deviation.size() != 0)
            impedance.deviation(k, 0) /= std::norm(Y);
        impedance.value(k, 0) = 1.0 / Y;
    }
    return withTerms(fitMixedImpedance(impedance).model, degree);
}

FractionalGrid gridOf(const RankedTake& data, const FractionalPnlss& model)
{
    return gridFor(
        model, data.take.measurement().sampleRate, data.response.frequency,
        static_cast<double>(data.records.estimation.front().input.rows()) / data.take.measurement().sampleRate, 1e-3);
}

FittedClass fractionalClass(const FractionalPnlss& model, const FractionalGrid& grid, int degree, int parameters)
{
    const auto play = [model, grid](const InputOutputRecord& record) {
        FractionalRecursion::Trajectory run;
        if (!FractionalRecursion(model, grid, false, false)
                 .run(model, fineInput(record.input, grid.substeps, record.periodic, record.skip), 1e100, run))
            run.output = Eigen::MatrixXd::Constant(record.input.rows(), 1, std::numeric_limits<double>::quiet_NaN());
        return run.output;
    };
    return {play, ofOrder("", model.form.linear.order(), degree) + withAlpha(model.alpha), parameters,
            isStable(model, grid), nullptr};
}

/// With all monomials, and a constant in the output: a sensor's offset is no dynamics.
Pnlss withAllTerms(const StateSpace& linear, int degree)
{
    auto model = withTerms(linear, degree, TermMask::full, true);
    model.free.col(0).head(linear.order()).setConstant(false);
    return model;
}

}  // namespace

FittedClass fitLinearClass(const RankedTake& data, const Progress&)
{
    const auto n = data.linear.order();
    return {[model = data.linear](const InputOutputRecord& record) { return simulate(model, record.input); },
            ofOrder("", n, 1), static_cast<int>(2 * n + 1), isStable(data.linear),
            toJson(NamedStateSpace {"linear",
                                    {std::string(name(data.input.quantity))},
                                    {std::string(name(data.output.quantity))},
                                    data.linear})};
}

FittedClass fitFractionalClass(const RankedTake& data, const Progress&)
{
    auto model = fractionalStart(data, 2);
    model.form.exponents.resize(0, model.form.exponents.cols());
    model.form.E.resize(model.form.E.rows(), 0);
    model.form.F.resize(model.form.F.rows(), 0);
    model.form.free.resize(model.form.free.rows(), 0);
    return fractionalClass(model, gridOf(data, model), 1, MixedImpedance::parameters);
}

FittedClass fitHammersteinClass(const RankedTake& data, const Progress& progress)
{
    HammersteinFitOptions fitting;
    fitting.degree = data.degree;
    const double rate = data.take.measurement().sampleRate;
    // As long as a woofer rings. Where that is too long for the filters to be solved at once, short ones are tried as
    // well, whose length and regularization are chosen.
    const auto ringing = std::min<Eigen::Index>(std::lround(ringingSeconds * rate), mostTaps / data.degree);
    const bool longer = ringing > fitting.length && !data.records.validation.empty();
    auto fit = fitHammerstein(rate, data.records.estimation, data.records.validation, fitting,
                              progress.part(0.0, longer ? 0.3 : 1.0));
    if (longer) {
        fitting.length = ringing;
        auto other = fitHammerstein(rate, data.records.estimation, data.records.validation, fitting,
                                    progress.part(0.3, 1.0));
        if (other.validationDb < fit.validationDb)
            fit = std::move(other);
    }
    return {[model = fit.model](const InputOutputRecord& record) { return simulate(model, record.input); },
            "degree " + std::to_string(fit.model.degree()) + ", " + std::to_string(fit.model.length()) + " taps",
            static_cast<int>(fit.model.parameters()), true, documentOf(data, "hammerstein", fit.model)};
}

FittedClass fitBlockClass(const RankedTake& data, const Progress& progress)
{
    BlockModelFitOptions fitting;
    fitting.degree = data.degree;
    fitting.maximumIterations = data.iterations;
    auto linear = data.linear;
    if (linear.order() > data.order) {
        IdentifyOptions identifying;
        identifying.sampleRate = data.take.measurement().sampleRate;
        identifying.order = data.order;
        linear = identify(data.response, identifying).model;
    }
    const auto fit = fitBlockModel(linear, data.records.estimation, data.records.validation, fitting, progress);
    auto description = ofOrder("", linear.order(), fitting.degree);
    for (const auto& step : fit.steps)
        if (step.branch)
            description += ", " + std::string(name(*step.branch));
    return {[model = fit.model](const InputOutputRecord& record) { return simulate(model, record.input); }, description,
            static_cast<int>(fit.model.parameters()), fit.stable, documentOf(data, "block", fit.model)};
}

FittedClass fitNarxClass(const RankedTake& data, const Progress& progress)
{
    NarxFitOptions fitting;
    fitting.outputLags = fitting.inputLags = data.order;
    fitting.degree = data.degree;
    fitting.maximumIterations = data.iterations;
    const auto fit = fitNarx(data.take.measurement().sampleRate, data.records.estimation, data.records.validation,
                             fitting, progress);
    return {[model = fit.model](const InputOutputRecord& record) { return simulate(model, record.input); },
            std::to_string(fit.model.outputLags) + " and " + std::to_string(fit.model.inputLags) + " lags, degree "
                + std::to_string(fitting.degree),
            static_cast<int>(fit.model.parameters()), fit.stable, documentOf(data, "narx", fit.model)};
}

FittedClass fitPnlssClass(const RankedTake& data, const Progress& progress)
{
    const auto& validation = data.records.validation;
    auto estimation = data.records.estimation;
    const double rate = data.take.measurement().sampleRate;
    PnlssFitOptions fitting;
    fitting.maximumIterations = data.iterations;
    fitting.enoughDb = data.records.enoughDb();
    PnlssFit best;
    double least = std::numeric_limits<double>::infinity();
    const auto consider = [&](PnlssFit fit) {
        const double error = std::isnan(fit.validationDb) ? fit.estimationDb : fit.validationDb;
        if (best.model.linear.order() == 0 || error < least) {
            least = error;
            best = std::move(fit);
        }
    };
    // A pole that only the linear model needed may hold the search up, so a driver's three states are tried as well.
    std::vector<int> orders {data.order};
    if (!data.orderGiven && data.order != 3)
        orders.push_back(3);
    const auto count = static_cast<double>(orders.size());
    double done = 0.0;
    if (estimation.front().periodic) {
        IdentifyOptions identifying;
        identifying.sampleRate = rate;
        std::vector<Pnlss> starts;
        for (const int order : orders) {
            identifying.order = order;
            starts.push_back(withAllTerms(identify(data.response, identifying).model, data.degree));
        }
        for (const auto search : {PnlssSearch::plain, PnlssSearch::guided, PnlssSearch::grown})
            for (const auto& start : starts) {
                const auto part = progress.part(done, std::min(1.0, done + 1.0 / (3.0 * count)));
                done += 1.0 / (3.0 * count);
                if (least < fitting.enoughDb)
                    continue;
                fitting.search = search;
                consider(fitPnlss(start, estimation, validation, fitting, part));
            }
    } else {
        // One record is played from its first sample on, whose state is estimated, and tells its noise by what is left.
        estimation.front().skip = 0;
        fitting.estimateInitialStates = fitting.judgeResidual = true;
        for (const int order : orders) {
            std::vector<PnlssStart> starts;
            for (const auto& linear : linearStarts(estimation.front(), rate, order))
                starts.push_back({withAllTerms(linear.model, data.degree), {linear.initial}});
            consider(fitPnlss(starts, estimation, validation, fitting,
                              progress.part(done, std::min(1.0, done + 1.0 / count))));
            done += 1.0 / count;
            if (best.untold && best.untold->reachedBy(best.estimationDb).value_or(false)
                && isHeld(best.estimationDb, estimation, best.validationDb, validation))
                break;
        }
    }
    return {
        [model = best.model](const InputOutputRecord& record) { return simulate(model, record.input); },
        ofOrder("", best.model.linear.order(), data.degree), static_cast<int>(Recursion(best.model, true).parameters()),
        best.stable,
        toJson(NamedPnlss {
            "pnlss", {std::string(name(data.input.quantity))}, {std::string(name(data.output.quantity))}, best.model})};
}

FittedClass fitFractionalPnlssClass(const RankedTake& data, const Progress& progress)
{
    const auto start = fractionalStart(data, data.degree);
    const auto grid = gridOf(data, start);
    FractionalPnlssOptions fitting;
    fitting.maximumIterations = std::min(data.iterations, 10);
    fitting.costTolerance = 1e-3;
    const auto fit = fitFractionalPnlss(start, grid, data.records.estimation, data.records.validation, fitting,
                                        progress);
    auto fitted = fractionalClass(fit.model, grid, data.degree,
                                  static_cast<int>(FractionalRecursion(fit.model, grid, true, true).parameters()));
    fitted.stable = fit.stable;
    fitted.document = toJson(NamedFractionalPnlss {"fractional-pnlss",
                                                   {std::string(name(data.input.quantity))},
                                                   {std::string(name(data.output.quantity))},
                                                   fit.model,
                                                   grid});
    return fitted;
}

}  // namespace excursion
