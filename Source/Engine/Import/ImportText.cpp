// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/ImportText.h"

#include "Engine/Document/TextFile.h"
#include "Engine/Document/Words.h"
#include "Engine/Error.h"
#include "Engine/Import/ColumnTitle.h"
#include "Engine/Import/Export.h"
#include "Engine/Import/PlainText.h"
#include "Engine/Import/ResponseColumns.h"
#include "Engine/Import/RewImpulse.h"
#include "Engine/Import/TextTable.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

using Kind = Error::Kind;

[[noreturn]] void refuseText(Kind kind, const std::string& source, const std::string& why)
{
    throw Error(kind, "'" + source + "' " + why);
}

/// One remark for all channels whose titles have no unit.
void tellUnits(const std::vector<ColumnQuantity>& columns, Measurement& measurement, const std::string& source)
{
    std::string names, units;
    for (const auto& column : columns)
        if (column.unit.empty()) {
            names += (names.empty() ? "" : ", ") + std::string(name(column.quantity));
            units += (units.empty() ? "" : ", ") + std::string(siUnit(column.quantity));
        }
    if (!names.empty())
        measurement.remarks.push_back("The titles of '" + source + "' have no unit for " + names + "; taken as " + units
                                      + ".");
}

Measurement timeSignals(const TextTable& table, const ImportOptions& options, const std::string& source)
{
    auto columns = options.columns;
    double sampleRate = options.sampleRate;
    for (std::size_t c = 0; c < table.titles().size(); ++c) {
        const auto title = columnTitle(table.titles()[c]);
        const auto unit = options.axis || !table.hasTitles() ? std::nullopt : timeFactor(title);
        if (unit && sampleRate == 0)
            sampleRate = sampleRateOf(table.column(c), *unit, source);
        if (options.columns.empty() && table.hasTitles() && !timeFactor(title))
            if (const auto found = columnNamed(table.titles()[c]))
                columns.push_back(*found);
    }
    if (options.axis && sampleRate == 0) {
        const auto index = table.find(options.axis->column);
        if (!index)
            refuseText(Kind::usage, source, "has no column '" + options.axis->column + "'.");
        sampleRate = sampleRateOf(table.column(*index), options.axis->factor, source);
    }
    std::vector<std::vector<double>> samples;
    for (const auto& mapped : columns) {
        const auto index = table.find(mapped.column);
        if (!index)
            refuseText(Kind::usage, source, "has no column '" + mapped.column + "'.");
        samples.push_back(table.column(*index));
    }
    auto measurement = measurementOfColumns(columns, samples, sampleRate, options, source);
    if (options.columns.empty())
        tellUnits(columns, measurement, source);
    return measurement;
}

/// What a file whose content does not say it holds by the convention of its ending.
std::optional<ResponseName> conventionOf(const std::string& source)
{
    const auto ending = endingOf(source);
    if (ending == ".zma")
        return responseNamed("impedance");
    return ending == ".frd" ? responseNamed("response") : std::nullopt;
}

Spectra mappedResponses(const TextTable& table, const ImportOptions& options, const std::string& source)
{
    ResponseColumns columns;
    columns.columns = options.responses;
    for (const auto& column : options.columns) {
        (void)column;
        refuseText(Kind::usage, source,
                   "cannot be both time signals and responses; map whole quantities or parts of responses, not both.");
    }
    if (options.axis && options.axis->isTime)
        refuseText(Kind::usage, source, "cannot hold responses over time; map a frequency.");
    if (options.axis) {
        columns.frequency = options.axis->column;
        columns.frequencyFactor = options.axis->factor;
        return spectraOf(table, columns, options.minimumPhase, source);
    }
    for (std::size_t c = 0; table.hasTitles() && c < table.titles().size(); ++c)
        if (const auto factor = frequencyFactor(columnTitle(table.titles()[c]))) {
            columns.frequency = std::to_string(c + 1);
            columns.frequencyFactor = *factor;
            return spectraOf(table, columns, options.minimumPhase, source);
        }
    refuseText(Kind::usage, source,
               "does not say which column is the frequency; add for example --map 1=frequency:Hz.");
}

}  // namespace

Take importText(std::string text, const std::string& source, const ImportOptions& options)
{
    if (isRewImpulse(text)) {
        if (!options.columns.empty() || !options.responses.empty() || options.axis || options.sampleRate > 0
            || options.from > 0 || options.to || options.as || options.minimumPhase || options.removeMean)
            refuseText(Kind::usage, source,
                       "is an impulse response of REW, which has no columns to map, tells its sample rate and is a "
                       "response of the pressure with its phase; leave --map, --rate, --from, --to, --as, "
                       "--minimum-phase and --remove-mean out.");
        return rewImpulse(text, source);
    }
    const TextTable table(std::move(text), source);
    const auto guess = conventionOf(source);
    const auto withName = [&](Spectra spectra) {
        if (options.sampleRate > 0 || options.from > 0 || options.to || options.removeMean)
            refuseText(Kind::usage, source,
                       "is a frequency response; --rate, --from, --to and --remove-mean are for time signals.");
        for (const auto& line : table.remarks())
            if (const auto mark = assumedMark.substr(2);
                line.starts_with(mark))  // what an earlier import had to assume
                spectra.remarks.push_back(line.substr(mark.size()));
        if (guess)
            spectra.driver.name = std::filesystem::path(source).stem().string();
        return spectra;
    };
    if (!options.responses.empty())
        return withName(mappedResponses(table, options, source));
    if (options.axis && !options.axis->isTime)
        refuseText(Kind::usage, source,
                   "has a mapped frequency, but no mapped response; add for example --map 2=impedance.magnitude --map "
                   "3=impedance.phase.");
    const bool overFrequency = table.hasTitles() && frequencyFactor(columnTitle(table.titles().front()));
    if (options.columns.empty()
        && (overFrequency || options.as || (guess && (!table.hasTitles() || !columnNamed(table.titles().front()))))) {
        if (table.titles().size() < 2)
            refuseText(Kind::input, source, "has one column of numbers, expected frequencies and a response.");
        return withName(
            spectraOf(table, responseColumnsOf(table, options.as, guess, source), options.minimumPhase, source));
    }
    if (!table.hasTitles() && options.columns.empty())
        refuseText(Kind::input, source,
                   "has no titles that say what its " + std::to_string(table.titles().size())
                       + " columns are; give --as impedance if they are frequency in "
                         "Hz, |Z| in ohm and phase in degrees, --as response if they are Hz, dB and degrees, or map "
                         "them by number, for "
                         "example --map 1=voltage --map 2=current, with excursion import.");
    if (options.minimumPhase)
        refuseText(Kind::usage, source,
                   "holds time signals, which have no phase to compute; leave --minimum-phase out.");
    return timeSignals(table, options, source);
}

Take importText(const std::filesystem::path& path, const ImportOptions& options)
{
    return importText(readPlainText(path), path.string(), options);
}

}  // namespace excursion
