// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Check/TakeResponse.h"

#include "Engine/Error.h"
#include "Engine/Estimate/EstimateFrf.h"
#include "Engine/Take/ChannelNamed.h"

namespace excursion {
namespace {

struct Ports {
    Quantity output, input;
};

/// What was asked for; else what the spectra are responses to (of an impedance that is the current), and the first
/// channel beside it.
Ports portsOf(const Spectra& spectra, const ResponsePorts& choice)
{
    if (!choice.input.empty()) {
        const auto input = channelNamed(spectra, choice.input).quantity;
        return {outputNamed(spectra, choice.output, input).quantity, input};
    }
    const auto* reference = spectra.input();
    if (!reference)
        throw Error(Error::Kind::data, "The take has neither a voltage nor a force; name an input.");
    const auto output = outputNamed(spectra, choice.output, reference->quantity).quantity;
    if (output != reference->quantity)
        return {output, reference->quantity};
    return {output, outputNamed(spectra, "", output).quantity};  // the admittance of an impedance
}

Frf ratio(const Spectra& spectra, Quantity output, Quantity input)
{
    Frf frf;
    frf.frequency = spectra.frequency;
    const auto& y = spectra.find(output)->values;
    const auto& u = spectra.find(input)->values;
    for (std::size_t k = 0; k < y.size(); ++k) {
        if (std::abs(u[k]) == 0.0)
            throw Error(Error::Kind::data,
                        "The " + std::string(name(input)) + " is zero at " + std::to_string(frf.frequency[k]) + " Hz.");
        frf.value.push_back(y[k] / u[k]);
    }
    return frf;
}

}  // namespace

TakeResponse responseOf(const PreparedTake& take, const ResponsePorts& choice)
{
    TakeResponse response;
    if (const auto* spectra = take.asResponses()) {
        const auto [output, input] = portsOf(*spectra, choice);
        response.frf = ratio(*spectra, output, input);
        response.remarks = spectra->remarks;
        response.output = output;
        response.input = input;
        return response;
    }
    const auto& measurement = take.settled();
    response.remarks = measurement.remarks;
    const auto input = choice.input.empty() ? measurement.input().quantity
                                            : channelNamed(measurement, choice.input).quantity;
    const auto output = outputNamed(measurement, choice.output, input).quantity;
    response.output = output;
    response.input = input;
    response.sampleRate = measurement.sampleRate;
    response.microphoneDistance = measurement.driver.microphoneDistance;
    if (!measurement.hasPeriods() && input != measurement.input().quantity)
        throw Error(Error::Kind::data,
                    "A take without periods gives responses to its own input only; name no other input.");
    response.frf = estimateFrf(measurement, output, input, choice.level);
    return response;
}

}  // namespace excursion
