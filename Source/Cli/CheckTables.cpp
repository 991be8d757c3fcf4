// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/CheckTables.h"

#include "Cli/OpenTake.h"
#include "Cli/Terminal.h"
#include "Engine/Document/DocumentFormat.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace excursion::cli {
namespace {

std::string figure(const std::optional<double>& value, int decimals)
{
    return value ? fixed(*value, decimals) : std::string("-");
}

/// The delay that the channel is blamed for; "none" when it was looked at and acquitted.
std::string delayText(const CheckReport& report, const ChannelFigures& c)
{
    for (const auto& p : report.problems)
        if (p.kind == "channel-delay" && p.channel == c.quantity)
            return fixed(p.value, 2);
    return c.delay && c.delay->conclusive ? "none" : "-";
}

template <class Json>
void put(Json& json, const char* key, const std::optional<double>& value)
{
    if (value)
        json[key] = *value;
}

}  // namespace

nlohmann::ordered_json checkJson(const CheckReport& report, const std::string& file, double sampleRate)
{
    nlohmann::ordered_json document = DocumentFormat {"excursion-check"}.with(
        {{"take", file}, {"fitForUse", report.fitForUse()}, {"verdict", report.verdict()}});
    auto& channels = document["channels"] = nlohmann::ordered_json::array();
    for (const auto& c : report.channels) {
        nlohmann::ordered_json channel {
            {"quantity", name(c.quantity)}, {"unit", c.unit}, {"rms", c.rms}, {"peak", c.peak}, {"offset", c.offset},
            {"clippedSamples", c.clipped}};
        put(channel, "snrDb", c.snrDb);
        put(channel, "repeatabilityDb", c.repeatabilityDb);
        put(channel, "driftPpm", c.driftPpm);
        if (c.settlingDb && *c.settlingDb > -300.0)
            channel["settlingDb"] = *c.settlingDb;
        for (const auto& band : c.bands)
            channel["bands"].push_back({{"low", band.low}, {"high", band.high}, {"snrDb", band.db}});
        if (c.delay && c.delay->conclusive)
            channel["delay"] = {{"against", name(c.delayReference)},
                                {"samples", c.delay->seconds * sampleRate},
                                {"standardError", c.delay->standardError * sampleRate},
                                {"clear", c.delay->clear},
                                {"inverted", c.delay->inverted}};
        channels.push_back(channel);
    }
    auto& problems = document["problems"] = nlohmann::ordered_json::array();
    for (const auto& p : report.problems) {
        nlohmann::ordered_json problem {
            {"kind", p.kind}, {"value", p.value}, {"unit", p.unit}, {"fatal", p.fatal}, {"sentence", p.sentence}};
        problem["channel"] = p.channel ? nlohmann::ordered_json(name(*p.channel)) : nlohmann::ordered_json();
        problems.push_back(problem);
    }
    return document;
}

void sayCheck(const CheckReport& report, Terminal& terminal)
{
    std::vector<std::vector<std::string>> rows;
    for (const auto& c : report.channels) {
        std::string worst = "-";
        if (!c.bands.empty()) {
            const auto band = *std::min_element(c.bands.begin(), c.bands.end(),
                                                [](const auto& a, const auto& b) { return a.db < b.db; });
            worst = fixed(band.db, 0) + " at " + fixed(band.low, 0) + " Hz";
        }
        const bool settled = !c.settlingDb || *c.settlingDb < -60.0;
        rows.push_back({std::string(name(c.quantity)), c.unit, significant(c.rms), significant(c.peak),
                        c.rms > 0.0 ? fixed(100.0 * std::abs(c.offset) / c.rms, 1) : "-", std::to_string(c.clipped),
                        figure(c.snrDb, 0), worst, figure(c.repeatabilityDb, 0),
                        !c.settlingDb ? "-"
                        : settled     ? "yes"
                                      : fixed(*c.settlingDb, 0),
                        figure(c.driftPpm, 2), delayText(report, c)});
    }
    terminal.table({"channel", "unit", "rms", "peak", "DC %", "clipped", "SNR dB", "worst octave", "repeats dB",
                    "settled", "drift ppm", "delay"},
                   rows);
    if (!report.problems.empty())
        terminal.say("");
    sayProblems(report.problems, terminal);
    terminal.say("");
    terminal.say(report.fitForUse() ? report.verdict() : std::string("The take is not fit for use."));
}

}  // namespace excursion::cli
