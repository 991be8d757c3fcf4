// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/ResponseColumns.h"

#include "Engine/Error.h"
#include "Engine/Signal/MinimumPhase.h"
#include "Engine/Take/Units.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

namespace excursion {
namespace {

using Kind = Error::Kind;
using Complex = std::complex<double>;

[[noreturn]] void refuseResponse(Kind kind, const std::string& source, const std::string& why)
{
    throw Error(kind, "'" + source + "' " + why);
}

/// The parts of one complex column, scaled, by ResponsePart.
struct Parts {
    ResponseName response;
    std::array<std::vector<double>, 5> values;
    std::array<std::string, 5> titles, units;
    std::array<double, 5> scales {};

    bool has(ResponsePart part) const { return !titles[static_cast<std::size_t>(part)].empty(); }
    std::vector<double>& of(ResponsePart part) { return values[static_cast<std::size_t>(part)]; }
};

std::string wordFor(ResponsePart part)
{
    static constexpr std::array words {"real part", "imaginary part", "magnitude", "level", "phase"};
    return words[static_cast<std::size_t>(part)];
}

std::vector<Parts> partsOf(const TextTable& table, const ResponseColumns& columns, const std::string& source)
{
    std::vector<Parts> all;
    for (const auto& column : columns.columns) {
        const auto index = table.find(column.column);
        if (!index)
            refuseResponse(Kind::usage, source, "has no column '" + column.column + "'.");
        auto same = std::find_if(all.begin(), all.end(), [&](const Parts& p) { return p.response == column.response; });
        if (same == all.end())
            same = all.insert(all.end(), Parts {column.response, {}, {}, {}, {}});
        const auto part = static_cast<std::size_t>(column.part);
        const auto& title = table.titles()[*index];
        if (same->has(column.part))
            refuseResponse(Kind::input, source,
                           "has more than one column for the " + wordFor(column.part) + " of the "
                               + textOf(column.response) + ", '" + same->titles[part] + "' and '" + title
                               + "'; map the one that is meant with --map of excursion import.");
        const auto scale = responseScale(column.response, column.part, column.unit);
        if (!scale)
            refuseResponse(Kind::usage, source,
                           "has '" + title + "' in '" + column.unit + "', expected "
                               + acceptedUnits(column.response, column.part) + ".");
        same->titles[part] = title;
        same->units[part] = column.unit;
        same->scales[part] = *scale;
        same->values[part] = table.column(*index);
    }
    return all;
}

/// Leaves out a line at 0 Hz and lines that repeat the one before; turns a table around that descends.
void tidy(std::vector<double>& frequency, std::vector<Parts>& all, const TextTable& table,
          std::vector<std::string>& remarks, const std::string& source)
{
    std::vector<std::vector<double>*> columns {&frequency};
    for (auto& parts : all)
        for (std::size_t p = 0; p < parts.values.size(); ++p)
            if (!parts.titles[p].empty()) {
                if (parts.values[p].size() != frequency.size())
                    refuseResponse(Kind::input, source,
                                   "has " + std::to_string(parts.values[p].size()) + " numbers in '" + parts.titles[p]
                                       + "', but " + std::to_string(frequency.size()) + " frequencies.");
                columns.push_back(&parts.values[p]);
            }
    const bool descends = frequency.size() > 1 && std::is_sorted(frequency.rbegin(), frequency.rend());
    std::vector<bool> keep(frequency.size(), true);
    for (std::size_t k = 0; k < frequency.size(); ++k) {
        const bool repeats = k > 0 && std::all_of(columns.begin(), columns.end(), [k](const auto* c) {
                                 return (*c)[k] == (*c)[k - 1];
                             });
        const bool ascends = k == 0 || frequency[k] > frequency[k - 1];
        if (frequency[k] < 0.0 || !std::isfinite(frequency[k]) || (!repeats && !descends && !ascends)
            || (descends && !repeats && k > 0 && frequency[k] == frequency[k - 1]))
            refuseResponse(Kind::input, source,
                           "has frequencies that are not positive or do not ascend, at line "
                               + std::to_string(table.lineOf(k)) + "; sort it by frequency.");
        keep[k] = !repeats && frequency[k] > 0.0;
        if (frequency[k] == 0.0 && !repeats)
            remarks.push_back("The line at 0 Hz of '" + source + "' was left out.");
    }
    for (auto* column : columns) {
        std::size_t count = 0;
        for (std::size_t k = 0; k < keep.size(); ++k)
            if (keep[k])
                (*column)[count++] = (*column)[k];
        column->resize(count);
        if (descends)
            std::reverse(column->begin(), column->end());
    }
    if (frequency.size() < 3)
        refuseResponse(Kind::input, source,
                       "has " + std::to_string(frequency.size()) + (frequency.size() == 1 ? " line" : " lines")
                           + " of numbers over frequency, expected at least 3.");
}

std::vector<Complex> complexOf(Parts& parts, const std::vector<double>& frequency, bool phaseless,
                               std::vector<std::string>& remarks, const std::string& source)
{
    using enum ResponsePart;
    const auto text = textOf(parts.response);
    std::vector<Complex> values;
    if (parts.has(real) || parts.has(imaginary)) {
        if (!parts.has(real) || !parts.has(imaginary))
            refuseResponse(Kind::input, source,
                           "has the " + wordFor(parts.has(real) ? real : imaginary) + " of the " + text + " in '"
                               + parts.titles[parts.has(real) ? 0 : 1] + "', but no column for its "
                               + wordFor(parts.has(real) ? imaginary : real) + ".");
        for (std::size_t k = 0; k < frequency.size(); ++k)
            values.emplace_back(parts.of(real)[k] * parts.scales[0], parts.of(imaginary)[k] * parts.scales[1]);
        return values;
    }
    if (!parts.has(magnitude) && !parts.has(decibels))
        refuseResponse(Kind::input, source, "has the phase of the " + text + ", but not its magnitude.");
    std::vector<double> sizes;
    for (std::size_t k = 0; k < frequency.size(); ++k) {
        const bool level = !parts.has(magnitude);
        const double number = (level ? parts.of(decibels) : parts.of(magnitude))[k];
        if (level ? std::abs(number) > 1000.0 : number < 0.0 || (number == 0.0 && parts.response.input))
            refuseResponse(Kind::input, source,
                           level ? "has a level beyond 1000 dB at " + std::to_string(frequency[k]) + " Hz."
                                 : "has a magnitude of the " + text + " that is not positive at "
                                       + std::to_string(frequency[k]) + " Hz.");
        sizes.push_back(level ? std::pow(10.0, number / 20) * parts.scales[3] : number * parts.scales[2]);
    }
    std::vector<double> angles;
    if (parts.has(phase)) {
        const auto& given = parts.of(phase);
        const auto [least, most] = std::minmax_element(given.begin(), given.end());
        if (parts.units[4].empty() && *most - *least > 0.35 && *least > -3.1416 && *most < 3.1416)
            refuseResponse(Kind::input, source,
                           "has a phase in '" + parts.titles[4]
                               + "' without a unit and within -3.14 .. 3.14, which may be radians; say it with "
                                 "--map '"
                               + parts.titles[4] + "=" + text + ".phase:rad' or :deg of excursion import.");
        for (const double angle : given)
            angles.push_back(angle * parts.scales[4]);
    } else if (phaseless) {
        angles = minimumPhase(frequency, sizes);
        remarks.push_back("The phase of the " + text
                          + " was not measured: it is the minimum phase that belongs to the magnitude, and a guess "
                            "within an octave of "
                            "both ends of the band.");
    } else {
        refuseResponse(Kind::data, source,
                       "has the magnitude of the " + text
                           + ", but not its phase; export the phase, too, or have it computed from the "
                             "magnitude with --minimum-phase of excursion import.");
    }
    for (std::size_t k = 0; k < frequency.size(); ++k)
        values.push_back(std::polar(sizes[k], angles[k]));
    return values;
}

struct ReadResponse {
    ResponseName name;
    std::string unit;
    std::vector<Complex> values;
};

/// SI, but V of the force or displacement of an electrical analogue.
std::string unitOf(const Parts& parts)
{
    if (!parts.response.input)
        for (const std::size_t p : {0u, 2u})
            if (!parts.units[p].empty())
                if (const auto known = unitNamed(parts.response.output, parts.units[p]))
                    return known->unit;
    return std::string(siUnit(parts.response.output));
}

}  // namespace

Spectra spectraOf(const TextTable& table, const ResponseColumns& columns, bool phaseless, const std::string& source)
{
    Spectra spectra;
    spectra.remarks = columns.remarks;
    const auto axis = table.find(columns.frequency);
    if (!axis)
        refuseResponse(Kind::usage, source, "has no column '" + columns.frequency + "'.");
    spectra.frequency = table.column(*axis);
    for (double& f : spectra.frequency)
        f *= columns.frequencyFactor;
    auto all = partsOf(table, columns, source);
    tidy(spectra.frequency, all, table, spectra.remarks, source);

    const auto points = spectra.frequency.size();
    std::vector<ReadResponse> read;
    for (auto& parts : all)
        read.push_back(
            {parts.response, unitOf(parts), complexOf(parts, spectra.frequency, phaseless, spectra.remarks, source)});
    if (read.empty())
        refuseResponse(Kind::usage, source, "has no column that was said to be a response.");
    const auto impedance = std::find_if(read.begin(), read.end(),
                                        [](const ReadResponse& r) { return r.name.isImpedance(); });
    const bool perVoltage = std::any_of(read.begin(), read.end(),
                                        [](const ReadResponse& r) { return r.name.input == Quantity::voltage; });
    if (impedance != read.end() && perVoltage) {
        for (auto& value : impedance->values)
            value = 1.0 / value;
        impedance->name = {Quantity::current, Quantity::voltage};
        impedance->unit = "A";
    }
    const auto input = read.front().name.input;
    for (const auto& response : read)
        if (response.name.input != input)
            refuseResponse(
                Kind::input, source,
                "holds the " + textOf(read.front().name) + " and the " + textOf(response.name)
                    + ", which are not responses to the same; map those of one input with --map of excursion import.");
    if (input)
        spectra.channels.push_back({*input, std::string(siUnit(*input)), std::vector<Complex>(points, 1.0)});
    for (auto& [response, unit, values] : read) {
        if (spectra.find(response.output))
            refuseResponse(Kind::input, source,
                           "has more than one column for the " + std::string(name(response.output)) + ".");
        if (std::any_of(values.begin(), values.end(), [](const Complex& v) { return !std::isfinite(std::norm(v)); }))
            refuseResponse(Kind::input, source, "has a " + textOf(response) + " that is beyond all numbers.");
        spectra.channels.push_back({response.output, unit, std::move(values)});
    }
    if (!spectra.find(Quantity::voltage) && !spectra.find(Quantity::force))
        refuseResponse(Kind::data, source,
                       "has spectra of neither voltage nor force (columns such as u_re_v and u_im_v), so nothing says "
                       "what drove the loudspeaker.");
    if (spectra.find(Quantity::pressure) && input == Quantity::voltage
        && std::any_of(columns.columns.begin(), columns.columns.end(), [](const ResponseColumn& c) {
               return c.part == ResponsePart::decibels && c.response.output == Quantity::pressure
                      && (c.unit.empty() || isDecibel(c.unit));
           }))
        spectra.remarks.push_back(
            "The level of the sound in '" + source
            + "' is taken as dB re 20 uPa at 1 V, as the file does not tell the voltage; shape and "
              "phase do not depend on it.");
    return spectra;
}

}  // namespace excursion
