// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/OpenResponse.h"

#include "Engine/Check/PreparedTake.h"
#include "Engine/Document/JsonField.h"
#include "Engine/Error.h"
#include "Engine/Estimate/Bla.h"
#include "Engine/Estimate/Welch.h"
#include "Engine/Import/ReadTake.h"

#include <filesystem>

namespace excursion::cli {
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
        throw Error(Error::Kind::data, "The take has neither a voltage nor a force; name an --input.");
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
Ports portsOf(const Spectra& spectra, const ResponseChoice& choice)
{
    if (!choice.input.empty()) {
        const auto input = chosen(spectra.channels, choice.input, std::nullopt);
        return {chosen(spectra.channels, choice.output, input), input};
    }
    const auto* reference = spectra.input();
    if (!reference)
        throw Error(Error::Kind::data, "The take has neither a voltage nor a force; name an --input.");
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

OpenResponse fromDocument(const std::string& path)
{
    const auto document = readJson(path);
    const JsonField field(document, "", path);
    field.requireFormat("excursion-bla", 1);
    OpenResponse open;
    open.output = field.at("output").text();
    open.input = field.at("input").text();
    open.frf.frequency = field.at("frequency").numbers();
    const auto re = field.at("re").numbers(), im = field.at("im").numbers();
    if (re.size() != open.frf.frequency.size() || im.size() != re.size())
        field.at("re").refuse("as many numbers as there are frequencies, as in im");
    for (std::size_t k = 0; k < re.size(); ++k)
        open.frf.value.emplace_back(re[k], im[k]);
    for (const auto& [key, target] :
         {std::pair {"noiseVariance", &open.frf.noiseVariance}, std::pair {"totalVariance", &open.frf.totalVariance}})
        if (field.has(key)) {
            *target = field.at(key).numbers();
            if (!target->empty() && target->size() != re.size())
                field.at(key).refuse("as many numbers as there are frequencies, or none");
        }
    return open;
}

}  // namespace

OpenResponse openResponse(const ResponseChoice& choice)
{
    if (std::filesystem::path(choice.path).extension() == ".json" && !std::filesystem::is_directory(choice.path)
        && std::filesystem::path(choice.path).filename() != "measurement.json")
        return fromDocument(choice.path);
    const PreparedTake take(readTake(choice.path));
    OpenResponse open;
    if (const auto* spectra = take.asResponses()) {
        const auto [output, input] = portsOf(*spectra, choice);
        open.frf = ratio(*spectra, output, input);
        open.remarks = spectra->remarks;
        open.output = name(output);
        open.input = name(input);
        return open;
    }
    const auto& measurement = take.measurement();
    open.remarks = measurement.remarks;
    const auto input = choice.input.empty() ? measurement.input().quantity
                                            : chosen(measurement.channels, choice.input, std::nullopt);
    const auto output = chosen(measurement.channels, choice.output, input);
    open.output = name(output);
    open.input = name(input);
    open.sampleRate = measurement.sampleRate;
    open.microphoneDistance = measurement.driver.microphoneDistance;
    if (measurement.excitation && !measurement.excitation->lines.empty()) {
        const int levels = static_cast<int>(measurement.excitation->levels.size());
        if (choice.level >= levels)
            throw Error(Error::Kind::usage, "The take has " + std::to_string(levels) + " levels, numbered from 0.");
        open.frf = bla(measurement, output, choice.level >= 0 ? choice.level : levels - 1, input).frf;
    } else {
        if (!choice.input.empty() && input != measurement.input().quantity)
            throw Error(Error::Kind::data,
                        "A take without periods gives responses to its own input only; leave --input out.");
        open.frf = welch(measurement, output, {}).frf;
    }
    return open;
}

Frf within(const Frf& frf, const std::vector<double>& band)
{
    if (band.empty())
        return frf;
    Frf cut;
    const auto copy = [](const std::vector<double>& from, std::size_t k, std::vector<double>& to) {
        if (!from.empty())
            to.push_back(from[k]);
    };
    for (std::size_t k = 0; k < frf.frequency.size(); ++k)
        if (frf.frequency[k] >= band[0] && frf.frequency[k] <= band[1]) {
            cut.frequency.push_back(frf.frequency[k]);
            cut.value.push_back(frf.value[k]);
            copy(frf.noiseVariance, k, cut.noiseVariance);
            copy(frf.totalVariance, k, cut.totalVariance);
        }
    return cut;
}

}  // namespace excursion::cli
