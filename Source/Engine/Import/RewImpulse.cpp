// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/RewImpulse.h"

#include "Engine/Document/Words.h"
#include "Engine/Error.h"
#include "Engine/Import/ColumnTitle.h"
#include "Engine/Import/ResponseName.h"
#include "Engine/Import/TextTable.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Take/Air.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace excursion {
namespace {

constexpr std::string_view intervalMark = "// sample interval";

struct Header {
    std::optional<double> peak, length, interval, start, offset;
    double low = 0.0, high = 0.0;  ///< Hz
    bool normalised = false, windowed = false, minimumPhase = false, clocked = false;
};

/// A number with a decimal point or comma; "24 000,0" and "19,999.9" have a mark for the thousands, too.
std::optional<double> looseNumber(std::string_view text)
{
    std::string digits;
    const auto lastMark = text.find_last_of(".,");
    for (std::size_t k = 0; k < text.size(); ++k) {
        const char c = text[k];
        if (c == '.' || c == ',') {
            // A mark that three digits follow to the end separates thousands, as these are frequencies with one
            // decimal.
            if (k == lastMark && text.size() - k != 4)
                digits += '.';
        } else if (c != ' ' && static_cast<unsigned char>(c) < 0x80) {
            digits += c;
        }
    }
    return parseNumber(digits);
}

void readRemark(std::string_view line, Header& header)
{
    const auto lower = lowerCase(line);
    const auto has = [&lower](std::string_view text) { return lower.find(text) != std::string::npos; };
    if (has("ir is normalised") || has("ir is normalized"))
        header.normalised = true;
    if (has("window has been applied"))
        header.windowed = true;
    if (has("is the min phase"))
        header.minimumPhase = true;
    if (has("timing reference"))
        header.clocked = true;
    const auto band = lower.find("measured over:");
    const auto to = lower.find(" to ", band == std::string::npos ? lower.size() : band);
    const auto hz = lower.find(" hz", to == std::string::npos ? lower.size() : to);
    if (band != std::string::npos && to != std::string::npos && hz != std::string::npos) {
        header.low = looseNumber(std::string_view(lower).substr(band + 14, to - band - 14)).value_or(0.0);
        header.high = looseNumber(std::string_view(lower).substr(to + 4, hz - to - 4)).value_or(0.0);
    }
}

std::string_view nextLine(std::string_view& text)
{
    const auto end = text.find('\n');
    auto line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    return trimmed(line);
}

}  // namespace

bool isRewImpulse(std::string_view text)
{
    const auto head = lowerCase(text.substr(0, 8192));
    return head.find(intervalMark) != std::string::npos
           || head.find("impulse response data saved by rew") != std::string::npos;
}

Spectra rewImpulse(std::string_view text, const std::string& source)
{
    const auto refuse = [&source](const std::string& why) {
        throw Error(Error::Kind::input, "'" + source + "' is an impulse response of REW that " + why);
    };
    Header header;
    std::vector<double> h;
    std::size_t number = 0;
    while (!text.empty()) {
        const auto line = nextLine(text);
        ++number;
        if (line.empty())
            continue;
        const auto stroke = line.find("//");
        if (stroke != std::string_view::npos) {
            const auto what = lowerCase(line.substr(stroke));
            const auto value = parseNumber(trimmed(line.substr(0, stroke)), true);
            if (!value || !std::isfinite(*value))
                refuse("has no number before '" + std::string(line.substr(stroke, 40)) + "' in line "
                       + std::to_string(number) + ".");
            for (const auto& [mark, target] : {std::pair {std::string_view("// peak value"), &header.peak},
                                               {"// response length", &header.length},
                                               {intervalMark, &header.interval},
                                               {"// start time", &header.start},
                                               {"// data offset", &header.offset}})
                if (what.starts_with(mark))
                    *target = *value;
            continue;
        }
        const auto sample = parseNumber(line, true);
        if (!sample && h.empty()) {
            readRemark(line, header);
            continue;
        }
        if (!sample || !std::isfinite(*sample))
            refuse("has '" + std::string(line.substr(0, 40)) + "' in line " + std::to_string(number)
                   + ", expected a finite sample.");
        h.push_back(*sample);
    }
    if (!header.interval || !(*header.interval >= 1e-8 && *header.interval <= 1.0))
        refuse("does not tell its sample interval; export it with its header.");
    if (header.length && *header.length != static_cast<double>(h.size()))
        refuse("has " + std::to_string(h.size()) + " samples, but its header claims "
               + std::to_string(static_cast<long long>(std::clamp(*header.length, -1e15, 1e15)))
               + "; export it again.");
    if (h.size() < 64)
        refuse("has only " + std::to_string(h.size()) + " samples.");

    const double interval = *header.interval, start = header.start.value_or(0.0),
                 spacing = 1.0 / (interval * static_cast<double>(h.size()));
    const double low = std::max(header.low, spacing),
                 high = header.high > low ? std::min(header.high, 0.5 / interval) : 0.5 / interval;
    const double offset = header.offset.value_or(0.0), peak = header.normalised ? header.peak.value_or(1.0) : 1.0;
    if (std::abs(offset) > 1000.0 || std::abs(start) > 1e6)
        refuse("has an impossible offset or start time in its header.");
    const double scale = peak * (header.offset ? referencePressure * std::pow(10.0, offset / 20) : 1.0);
    Spectra spectra;
    Spectra::Channel voltage {Quantity::voltage, "V", {}}, pressure {Quantity::pressure, "Pa", {}};
    const auto H = fft(h);
    const double step = std::exp2(1.0 / 96);
    double next = low;
    for (std::size_t k = 1; k < H.size(); ++k) {
        const double f = static_cast<double>(k) * spacing;
        if (f < next * (1.0 - 1e-9) || f > high)
            continue;
        next = f * step;
        const auto value = scale * H[k] * std::polar(1.0, -2.0 * std::numbers::pi * std::fmod(f * start, 1.0));
        if (!std::isfinite(std::norm(value)))
            refuse("is beyond all numbers at " + std::to_string(f) + " Hz.");
        spectra.frequency.push_back(f);
        voltage.values.emplace_back(1.0);
        pressure.values.push_back(value);
    }
    if (spectra.frequency.size() < 3)
        refuse("was measured over a band in which fewer than 3 of its lines lie.");
    spectra.channels = {std::move(voltage), std::move(pressure)};
    const auto told = [&](const std::string& sentence) {
        spectra.remarks.push_back("The impulse response '" + source + "' " + sentence);
    };
    told(header.offset ? "is taken as sound pressure at 1 V, 0 dB being 20 uPa at its data offset, as the file does "
                         "not tell the voltage; shape and phase do not depend on it."
                       : "has no level that the file tells: a sample of 1 is taken as 1 Pa at 1 V; shape and phase do "
                         "not depend on it.");
    if (header.normalised && !header.peak)
        told("is normalised, and its peak value is not in the file.");
    if (header.windowed)
        told("was windowed before it was exported, which smooths it.");
    if (header.minimumPhase)
        told("is its minimum phase version: the delay was taken off.");
    else if (!header.clocked)
        told("does not say that it was measured with a timing reference: its delay may be arbitrary.");
    return spectra;
}

}  // namespace excursion
