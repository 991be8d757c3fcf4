// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/ResponseName.h"

#include "Engine/Document/Words.h"
#include "Engine/Import/ColumnUnits.h"
#include "Engine/Take/Air.h"
#include "Engine/Take/Units.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace excursion {
namespace {

std::optional<Quantity> quantityOf(std::string_view text)
{
    const auto lower = lowerCase(text);
    if (const auto known = quantityNamed(lower))
        return known;
    static constexpr std::array<std::pair<std::string_view, Quantity>, 10> names {
        {{"u", Quantity::voltage},
         {"i", Quantity::current},
         {"x", Quantity::displacement},
         {"excursion", Quantity::displacement},
         {"v", Quantity::velocity},
         {"a", Quantity::acceleration},
         {"p", Quantity::pressure},
         {"spl", Quantity::pressure},
         {"mic", Quantity::pressure},
         {"f", Quantity::force}}};
    for (const auto& [name, quantity] : names)
        if (lower == name)
            return quantity;
    return std::nullopt;
}

/// Factor of a unit such as "mm/V" or "(m/s)/V" as that of a ratio.
std::optional<double> ratioFactor(Quantity output, Quantity input, std::string_view unit)
{
    for (auto at = unit.find('/'); at != std::string_view::npos; at = unit.find('/', at + 1)) {
        const auto above = withoutBrackets(unit.substr(0, at)), below = withoutBrackets(unit.substr(at + 1));
        const auto y = unitNamed(output, above), u = unitNamed(input, below);
        if (y && u && y->unit == siUnit(output) && u->unit == siUnit(input))
            return y->factor / u->factor;
    }
    return std::nullopt;
}

std::string squeezed(std::string_view text)
{
    std::string result;
    for (const char c : lowerCase(text))
        if (c != ' ' && c != '(' && c != ')')
            result += c;
    return result;
}

}  // namespace

std::optional<ResponseName> responseNamed(std::string_view text)
{
    const auto lower = lowerCase(text);
    if (lower == "impedance" || lower == "z")
        return ResponseName {Quantity::voltage, Quantity::current};
    if (lower == "admittance" || lower == "y")
        return ResponseName {Quantity::current, Quantity::voltage};
    if (lower == "response" || lower == "spl")
        return ResponseName {Quantity::pressure, Quantity::voltage};
    const auto stroke = lower.find('/');
    const auto output = quantityOf(lower.substr(0, stroke));
    if (stroke == std::string::npos)
        return output ? std::optional(ResponseName {*output, std::nullopt}) : std::nullopt;
    const auto input = quantityOf(lower.substr(stroke + 1));
    if (!output || !input || *output == *input)
        return std::nullopt;
    return ResponseName {*output, *input};
}

std::string textOf(const ResponseName& response)
{
    if (response.isImpedance())
        return "impedance";
    auto text = std::string(name(response.output));
    return response.input ? text + "/" + std::string(name(*response.input)) : text;
}

std::optional<ResponsePart> responsePartNamed(std::string_view text)
{
    const auto lower = lowerCase(text);
    const auto isOneOf = [&lower](std::initializer_list<std::string_view> words) {
        return std::find(words.begin(), words.end(), lower) != words.end();
    };
    if (isOneOf({"re", "real"}))
        return ResponsePart::real;
    if (isOneOf({"im", "imag", "imaginary"}))
        return ResponsePart::imaginary;
    if (isOneOf({"magnitude", "mag", "magn", "abs", "modulus", "amplitude", "ampl"}))
        return ResponsePart::magnitude;
    if (isOneOf({"db", "level"}))
        return ResponsePart::decibels;
    if (isOneOf({"phase", "arg", "angle", "phi"}))
        return ResponsePart::phase;
    return std::nullopt;
}

bool isSoundLevel(std::string_view unit)
{
    const auto text = squeezed(unit);
    return text == "dbspl" || text == "spl" || text == "dbre20upa" || text == "dbre20\u00b5pa"
           || text == "dbre20\u03bcpa" || text == "dbre.20upa" || text == "db/20upa";
}

bool isDecibel(std::string_view unit) { return squeezed(unit) == "db" || isSoundLevel(unit); }

std::optional<double> responseScale(const ResponseName& response, ResponsePart part, std::string_view unit)
{
    if (part == ResponsePart::phase)
        return angleUnit(unit.empty() ? "deg" : unit);
    if (part == ResponsePart::decibels) {
        const bool sound = response.output == Quantity::pressure;
        if (isDecibel(unit) || unit.empty())
            return sound                                           ? std::optional(referencePressure)
                   : isSoundLevel(unit) || !response.isImpedance() ? std::nullopt
                                                                   : std::optional(1.0);
    }
    if (unit.empty())
        return 1.0;
    if (!response.input) {
        const auto known = unitNamed(response.output, unit);
        return known ? std::optional(known->factor) : std::nullopt;
    }
    if (response.isImpedance())
        if (const auto known = resistanceUnit(unit))
            return known;
    return ratioFactor(response.output, *response.input, unit);
}

std::string acceptedUnits(const ResponseName& response, ResponsePart part)
{
    if (part == ResponsePart::phase)
        return "deg or rad";
    if (response.isImpedance())
        return "ohm, kohm or V/A";
    if (!response.input)
        return acceptedUnits(response.output);
    const auto ratio = std::string(siUnit(response.output)) + "/" + std::string(siUnit(*response.input));
    if (part == ResponsePart::decibels && response.output == Quantity::pressure)
        return "dBSPL or " + ratio + " (what 0 dB stands for)";
    return (part == ResponsePart::decibels ? "what 0 dB stands for, such as " : "") + ratio + " or a multiple";
}

std::optional<ResponseName> ratioOfUnit(std::string_view unit)
{
    std::optional<ResponseName> found;
    for (const auto output : quantities)
        for (const auto input : quantities)
            if (output != input && ratioFactor(output, input, unit)) {
                if (found)
                    return std::nullopt;
                found = ResponseName {output, input};
            }
    return found;
}

}  // namespace excursion
