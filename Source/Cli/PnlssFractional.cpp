// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Alpha.h"
#include "Cli/Pnlss.h"
#include "Engine/GreyBox/MixedImpedance.h"
#include "Engine/GreyBox/MixedOrderPnlss.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalSimulation.h"

#include "Engine/Error.h"
#include "Engine/Fractional/FractionalIdentify.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalPnlssFile.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalPnlssFit.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalRecursion.h"

#include <cmath>
#include <filesystem>

namespace excursion::cli {
namespace {

FractionalPnlss mixedStart(const PnlssArguments& options, const PnlssTake& data, std::optional<double> alpha)
{
    if (data.input->quantity != Quantity::voltage || data.output->quantity != Quantity::current)
        throw Error(Error::Kind::usage,
                    "--mixed explains a current by a voltage, and this take, or the choice of channels, is of others.");
    auto impedance = options.response;
    std::swap(impedance.input, impedance.output);
    impedance.input = name(Quantity::current);
    impedance.output = name(Quantity::voltage);
    MixedImpedanceOptions wanted;
    wanted.alpha = alpha;
    return withTerms(fitMixedImpedance(frequencyDataOf(openResponse(impedance).frf), wanted).model, options.degree,
                     maskNamed(options.mask), options.offset);
}

FractionalPnlss commensurateStart(const PnlssArguments& options, std::optional<double> alpha)
{
    FractionalOptions wanted;
    wanted.order = options.order;
    wanted.alpha = alpha;
    wanted.mostAlpha = 0.98;
    const auto linear = identifyFractional(frequencyDataOf(openResponse(options.response).frf), wanted).model;
    return withTerms(linear, options.degree, maskNamed(options.mask), options.offset);
}

}  // namespace

PnlssOutcome fractionalPnlss(const PnlssArguments& options, const PnlssTake& data, Terminal& terminal)
{
    const auto &estimation = data.records.estimation, &validation = data.records.validation;
    PnlssOutcome outcome;
    NamedFractionalPnlss named;
    if (!options.model.empty()) {
        named = readDocument(options.model, fractionalPnlssFromJson);
        if (named.grid.sampleRate != data.take.sampleRate)
            throw Error(Error::Kind::data, "The model was made for " + significant(named.grid.sampleRate, 8)
                                               + " Hz, the take is at " + significant(data.take.sampleRate, 8)
                                               + " Hz.");
        outcome.estimationDb = relativeErrorDb(named.model, named.grid, estimation);
        outcome.validationDb = relativeErrorDb(named.model, named.grid, validation);
        outcome.stable = isStable(named.model, named.grid) && std::isfinite(outcome.estimationDb);
        outcome.alpha = significant(named.model.alpha, 5);
    } else {
        const auto alpha = alphaFrom(options.alpha);
        if (alpha && *alpha >= 1.0)
            throw Error(
                Error::Kind::usage,
                "A polynomial model has states of an order --alpha below 1; leave --alpha out for whole orders.");
        auto start = options.mixed ? mixedStart(options, data, alpha) : commensurateStart(options, alpha);
        if (options.noOutputTerms)
            keepOutputLinear(start.form);
        const double seconds = static_cast<double>(estimation.front().input.rows()) / data.take.sampleRate;
        const auto grid = gridFor(start, data.take.sampleRate, openResponse(options.response).frf.frequency, seconds);
        FractionalPnlssOptions fitting;
        fitting.maximumIterations = options.iterations;
        fitting.alphaFree = !alpha;
        const auto fit = fitFractionalPnlss(start, grid, estimation, validation, fitting, terminal.progress());
        outcome = {relativeErrorDb(start, grid, validation.empty() ? estimation : validation),
                   fit.estimationDb,
                   fit.validationDb,
                   fit.stable,
                   fit,
                   fit.history,
                   withError(fit.model.alpha, fit.alphaStandardError),
                   {},
                   {},
                   {},
                   FractionalRecursion(fit.model, grid, true, !alpha).parameters()};
        std::vector<Eigen::MatrixXd> played;
        for (const auto& record : estimation)
            played.push_back(simulate(start, record.input, grid));
        outcome.constantShare = constantShareOf(start.form.exponents, estimation, played);
        named = {std::filesystem::path(options.response.path).stem().string(),
                 {std::string(name(data.input->quantity))},
                 {std::string(name(data.output->quantity))},
                 fit.model,
                 grid};
    }
    outcome.model = toJson(named);
    outcome.play = [model = named.model, grid = named.grid](const Eigen::MatrixXd& u) {
        return simulate(model, u, grid);
    };
    return outcome;
}

}  // namespace excursion::cli
