// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/OpenDriver.h"
#include "Cli/OpenModel.h"
#include "Cli/Pnlss.h"

#include "Engine/Error.h"
#include "Engine/Linear/Bilinear.h"
#include "Engine/Linear/Identify.h"
#include "Engine/Polynomial/Block/BlockModelFile.h"
#include "Engine/Polynomial/Pnlss/LinearStarts.h"
#include "Engine/Polynomial/Pnlss/PnlssFile.h"
#include "Engine/Ranking/TaylorExpansion.h"

#include <filesystem>

namespace excursion::cli {
namespace {

Pnlss termsOn(const StateSpace& linear, const PnlssArguments& options)
{
    const auto order = static_cast<int>(linear.order());
    return options.terms.empty() ? withTerms(linear, options.degree, maskNamed(options.mask), options.offset)
                                 : withTerms(linear, monomialsNamed(options.terms, order, 1));
}

void requireRate(double rate, const PnlssTake& data, const std::string& what)
{
    if (rate != data.take.sampleRate)
        throw Error(Error::Kind::data, what + " is one at " + significant(rate, 8) + " Hz, the take at "
                                           + significant(data.take.sampleRate, 8) + " Hz.");
}

void requirePorts(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs,
                  const PnlssTake& data, const std::string& what)
{
    const std::string input(name(data.input->quantity)), output(name(data.output->quantity));
    if (inputs != std::vector {input} || outputs != std::vector {output})
        throw Error(Error::Kind::data, what + " connects " + (inputs.empty() ? "nothing" : inputs[0]) + " and "
                                           + (outputs.empty() ? "nothing" : outputs[0]) + ", the fit " + input + " and "
                                           + output + ".");
}

/// What is kept as a polynomial model, a driver or a linear model, at the rate of the take.
Pnlss keptStart(const PnlssArguments& options, const PnlssTake& data)
{
    const auto what = "The start " + options.start;
    const bool folder = std::filesystem::is_directory(options.start);
    const auto document = folder ? nlohmann::json() : readJson(options.start);
    const auto format = document.is_object() ? document.value("format", "") : std::string();
    if (format == "excursion-pnlss") {
        if (options.chosenTerms)
            throw Error(Error::Kind::usage,
                        what + " has its monomials: leave --degree, --mask, --terms and --offset out.");
        const auto named = readDocument(options.start, pnlssFromJson);
        requirePorts(named.inputs, named.outputs, data, what);
        requireRate(named.model.linear.sampleRate, data, what);
        return named.model;
    }
    if (format == "excursion-block-model") {
        if (options.chosenTerms)
            throw Error(Error::Kind::usage,
                        what + " has its monomials: leave --degree, --mask, --terms and --offset out.");
        const auto named = readDocument(options.start, blockModelFromJson);
        requirePorts({named.input}, {named.output}, data, what);
        requireRate(named.model.linear.sampleRate, data, what);
        return closedLoop(named.model);
    }
    if (folder || format == "excursion-model" || format == "excursion-ladder") {
        if (data.input->quantity != Quantity::voltage)
            throw Error(Error::Kind::data, what + " is a driver under a voltage, the fit is one under a "
                                               + std::string(name(data.input->quantity)) + ".");
        // As far from rest as the take went, and with all monomials that are to be fitted
        const auto driver = discretized(expand(openDriver(options.start), data.output->quantity, {options.degree, 1.0}),
                                        data.take.sampleRate);
        auto start = termsOn(driver.linear, options);
        for (Eigen::Index k = 0; k < start.terms(); ++k)
            for (Eigen::Index own = 0; own < driver.terms(); ++own)
                if (start.exponents.row(k) == driver.exponents.row(own)) {
                    start.E.col(k) = start.free.col(k).head(start.E.rows()).select(driver.E.col(own), 0.0);
                    start.F.col(k) = start.free.col(k).tail(start.F.rows()).select(driver.F.col(own), 0.0);
                }
        return start;
    }
    const auto open = openModel(options.start);
    if (open.fractional)
        throw Error(Error::Kind::data, what + " is of fractional order; a start is one of whole order.");
    if (open.named.delay != 0.0)
        throw Error(Error::Kind::data,
                    what + " has a delay, which the states of a polynomial model do not hold; identify one without.");
    requirePorts(open.named.inputs, open.named.outputs, data, what);
    if (open.named.model.continuous())
        return termsOn(toDiscrete(open.named.model, data.take.sampleRate), options);
    requireRate(open.named.model.sampleRate, data, what);
    return termsOn(open.named.model, options);
}

/// The best linear approximation of periods; of a take without, what its one record tells.
std::vector<PnlssStart> foundStarts(const PnlssArguments& options, const PnlssTake& data)
{
    if (data.periodic()) {
        IdentifyOptions identifying;
        identifying.order = options.order;
        identifying.sampleRate = data.take.sampleRate;
        const auto response = frequencyDataOf(openResponse(options.response).frf);
        return {{termsOn(identify(response, identifying).model, options), {}}};
    }
    std::vector<PnlssStart> starts;
    for (const auto& linear : linearStarts(data.records.estimation.front(), data.take.sampleRate, options.order))
        starts.push_back({termsOn(linear.model, options), {linear.initial}});
    return starts;
}

}  // namespace

std::vector<PnlssStart> startsFor(const PnlssArguments& options, const PnlssTake& data)
{
    std::vector<PnlssStart> starts;
    if (options.start.empty())
        starts = foundStarts(options, data);
    else {
        starts = {{keptStart(options, data), {}}};
        if (options.order != 0 && options.order != starts[0].model.linear.order())
            throw Error(Error::Kind::usage, "The start is of order " + std::to_string(starts[0].model.linear.order())
                                                + ", not of --order " + std::to_string(options.order)
                                                + "; leave --order out.");
        if (!data.periodic())
            starts[0].initialStates = {initialStateOf(starts[0].model, data.records.estimation.front())};
    }
    if (options.noOutputTerms)
        for (auto& start : starts)
            keepOutputLinear(start.model);
    return starts;
}

}  // namespace excursion::cli
