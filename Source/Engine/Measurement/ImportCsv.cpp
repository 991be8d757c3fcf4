// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Measurement/ImportCsv.h"

#include "Engine/Document/TextFile.h"
#include "Engine/Error.h"
#include "Engine/Measurement/DelimitedText.h"
#include "Engine/Measurement/Units.h"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace excursion {
namespace {

using Kind = Error::Kind;

std::string lower(std::string text)
{
    for (char& c : text)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

[[noreturn]] void refuse(Kind kind, const std::string& source, const std::string& why)
{
    throw Error(kind, "'" + source + "' " + why);
}

bool isFrequency(const std::string& column)
{
    const auto text = lower(column);
    const auto known = {"frequency", "frequency_hz", "frequency [hz]", "frequency (hz)", "freq", "freq_hz", "freq [hz]", "f", "f_hz", "f [hz]"};
    return std::find(known.begin(), known.end(), text) != known.end();
}

/// Seconds a step of the time column's unit; 0 when the column is not a time.
double timeUnit(const std::string& column)
{
    const auto text = lower(column);
    const auto isOneOf = [&text](std::initializer_list<const char*> names) { return std::find(names.begin(), names.end(), text) != names.end(); };
    if (isOneOf({"time", "t", "time_s", "t_s", "time [s]", "time (s)", "t [s]", "t (s)"}))
        return 1.0;
    return isOneOf({"time_ms", "t_ms", "time [ms]", "time (ms)", "t [ms]", "t (ms)"}) ? 1e-3 : 0.0;
}

double rateOf(const std::vector<double>& time, double unit, const std::string& source)
{
    if (time.size() < 3)
        refuse(Kind::data, source, "has fewer than 3 times, too few to tell the sample rate.");
    const double step = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
    for (std::size_t n = 0; n < time.size(); ++n)   // against the line, so that printed digits do not add up
        if (!(step > 0) || std::abs(time[n] - time.front() - static_cast<double>(n) * step) > 0.01 * step + 1e-9 * std::abs(time.back()))
            refuse(Kind::data, source, "is not evenly sampled: its time column leaves the even grid at row " + std::to_string(n)
                                           + "; resample it, or leave the time column out and give --rate.");
    return 1.0 / (step * unit);
}

Measurement timeSignals(const DelimitedText& table, const ImportOptions& options, const std::string& source)
{
    auto columns = options.columns;
    double sampleRate = options.sampleRate;
    for (std::size_t c = 0; c < table.header().size(); ++c) {
        const auto& title = table.header()[c];
        const double unit = timeUnit(title);
        if (unit > 0 && sampleRate == 0)
            sampleRate = rateOf(table.column(c), unit, source);
        if (options.columns.empty() && unit == 0)
            if (const auto found = columnNamed(title))
                columns.push_back(*found);
    }
    std::vector<std::vector<double>> samples;
    for (const auto& mapped : columns) {
        const auto index = table.find(mapped.column);
        if (!index)
            refuse(Kind::usage, source, "has no column '" + mapped.column + "'.");
        samples.push_back(table.column(*index));
    }
    return measurementOfColumns(columns, samples, sampleRate, options, source);
}

Spectra spectra(const DelimitedText& table, const std::string& source)
{
    Spectra result;
    result.frequency = table.column(0);
    const auto points = result.frequency.size();
    for (std::size_t k = 0; k < points; ++k)
        if (result.frequency[k] <= (k == 0 ? 0.0 : result.frequency[k - 1]))
            refuse(Kind::input, source, "has frequencies that are not positive or do not ascend, at row " + std::to_string(k + 1) + ".");
    for (std::size_t c = 1; c < table.header().size(); ++c) {
        const auto& title = table.header()[c];
        const auto at = lower(title).find("_re");
        if (at == std::string::npos)
            continue;
        auto other = title, plain = title;
        other.replace(at + 1, 2, std::isupper(static_cast<unsigned char>(title[at + 1])) ? "IM" : "im");
        plain.erase(at, 3);
        const auto meaning = columnNamed(plain);
        const auto imaginary = table.find(other);
        if (!meaning)
            refuse(Kind::input, source, "has a column '" + title + "' whose quantity and unit are not understood.");
        if (!imaginary)
            refuse(Kind::input, source, "has a column '" + title + "' but no column '" + other + "'.");
        if (result.find(meaning->quantity))
            refuse(Kind::input, source, "has more than one column for the " + std::string(name(meaning->quantity)) + ".");
        const auto scale = unitNamed(meaning->quantity, meaning->unit.empty() ? siUnit(meaning->quantity) : std::string_view(meaning->unit));
        const auto re = table.column(c), im = table.column(*imaginary);
        if (re.size() != points || im.size() != points)
            refuse(Kind::input, source, "has fewer numbers in '" + title + "' or '" + other + "' than frequencies.");
        Spectra::Channel channel {meaning->quantity, scale->unit, {}};
        for (std::size_t k = 0; k < points; ++k)
            channel.values.emplace_back(re[k] * scale->factor, im[k] * scale->factor);
        result.channels.push_back(std::move(channel));
    }
    if (!result.find(Quantity::voltage) && !result.find(Quantity::force))
        refuse(Kind::data, source, "has spectra of neither voltage nor force (columns u_re_v and u_im_v), so nothing says what drove the loudspeaker.");
    return result;
}

} // namespace

Take importCsv(const std::filesystem::path& path, const ImportOptions& options)
{
    const auto source = path.string();
    const DelimitedText table(readText(path), source);
    if (options.columns.empty() && isFrequency(table.header().front()))
        return spectra(table, source);
    return timeSignals(table, options, source);
}

} // namespace excursion
