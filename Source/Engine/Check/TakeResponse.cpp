// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Check/TakeResponse.h"

#include "Engine/Error.h"
#include "Engine/Estimate/Bla.h"
#include "Engine/Estimate/Welch.h"

namespace excursion {
namespace {

template <class Channels>
Quantity chosen(const Channels& channels, const std::string& wanted, std::optional<Quantity> other)
{
    if (!wanted.empty()) {
        const auto quantity = quantityNamed(wanted);
        for (const auto& channel : channels)
            if (quantity && channel.quantity == *quantity)
                return *quantity;
        throw Error(Error::Kind::usage, "The take has no channel \"" + wanted + "\".");
    }
    if (!other) {
        for (const auto first : {Quantity::voltage, Quantity::force})
            for (const auto& channel : channels)
                if (channel.quantity == first)
                    return first;
        throw Error(Error::Kind::data, "The take has neither a voltage nor a force; name an input.");
    }
    for (const auto& channel : channels)
        if (channel.quantity != *other)
            return channel.quantity;
    throw Error(Error::Kind::data, "The take has no channel beside its input.");
}

struct Ports {
    Quantity output, input;
};

/// What was asked for; else what the spectra are responses to (of an impedance that is the current), and the first
/// channel beside it.
Ports portsOf(const Spectra& spectra, const ResponsePorts& choice)
{
    if (!choice.input.empty()) {
        const auto input = chosen(spectra.channels, choice.input, std::nullopt);
        return {chosen(spectra.channels, choice.output, input), input};
    }
    const auto* reference = spectra.input();
    if (!reference)
        throw Error(Error::Kind::data, "The take has neither a voltage nor a force; name an input.");
    const auto output = chosen(spectra.channels, choice.output, reference->quantity);
    if (output != reference->quantity)
        return {output, reference->quantity};
    return {output, chosen(spectra.channels, "", output)};  // the admittance of an impedance
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
    const auto& measurement = take.measurement();
    response.remarks = measurement.remarks;
    const auto input = choice.input.empty() ? measurement.input().quantity
                                            : chosen(measurement.channels, choice.input, std::nullopt);
    const auto output = chosen(measurement.channels, choice.output, input);
    response.output = output;
    response.input = input;
    response.sampleRate = measurement.sampleRate;
    response.microphoneDistance = measurement.driver.microphoneDistance;
    if (measurement.excitation && !measurement.excitation->lines.empty()) {
        const int levels = static_cast<int>(measurement.excitation->levels.size());
        if (choice.level >= levels)
            throw Error(Error::Kind::usage, "The take has " + std::to_string(levels)
                                                + (levels == 1 ? " level" : " levels") + ", numbered from 0.");
        response.frf = bla(measurement, output, choice.level >= 0 ? choice.level : levels - 1, input).frf;
    } else {
        if (!choice.input.empty() && input != measurement.input().quantity)
            throw Error(Error::Kind::data,
                        "A take without periods gives responses to its own input only; name no other input.");
        response.frf = welch(measurement, output, {}).frf;
    }
    return response;
}

}  // namespace excursion
