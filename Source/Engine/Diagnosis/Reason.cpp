// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Reason.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace excursion {
namespace {

std::string number(double value, const char* format = "%.1f")
{
    char text[48];
    std::snprintf(text, sizeof text, format, value);   // the C locale is never changed
    return text;
}

std::string frequency(double hertz)
{
    return hertz < 1000.0 ? number(hertz, "%.0f") + " Hz" : number(hertz / 1000.0, "%.3g") + " kHz";
}

/// The channel whose error stands highest above its noise.
const ChannelComparison& worst(const Comparison& comparison)
{
    return *std::max_element(comparison.channels.begin(), comparison.channels.end(),
                             [](const auto& a, const auto& b) { return a.total.chi < b.total.chi; });
}

std::string parity(const ChannelComparison& channel)
{
    if (channel.kindsByLevel.empty())
        return "";
    const auto& kinds = channel.kindsByLevel.back();
    std::string text;
    const auto add = [&](const char* what, const std::optional<double>& level) {
        if (level)
            text += (text.empty() ? "" : ", ") + std::string(what) + " at " + number(*level) + " dB";
    };
    add("excited lines", kinds.linear);
    add("odd detection lines", kinds.odd);
    add("even ones", kinds.even);
    if (!text.empty() && kinds.noise)
        text += ", noise at " + number(*kinds.noise) + " dB";
    return text;
}

/// A mechanical analogue may tell its displacement in volts, its velocity in V/s.
bool isAnalogue(const Comparison& comparison)
{
    return std::any_of(comparison.channels.begin(), comparison.channels.end(), [](const auto& channel) {
        return channel.unit == "V" && channel.quantity != Quantity::voltage;
    });
}

std::string law(const Model& model, const Effect& effect, bool analogue)
{
    for (const auto& curve : laws(model)) {
        if (curve.effectId != effect.id())
            continue;
        const double rest = curve.value[curve.value.size() / 2];
        const double low = 100.0 * (curve.value.front() / rest - 1.0), high = 100.0 * (curve.value.back() / rest - 1.0);
        const bool metres = curve.info.argumentUnit == "m" && !analogue;
        auto unit = metres ? "mm" : curve.info.argumentUnit;
        if (analogue && unit.front() == 'm')
            unit.front() = 'V';
        const double end = curve.argument.back() * (metres ? 1e3 : 1.0);
        return curve.info.name + " comes out " + number(std::round(low) + 0.0, "%+.0f") + " % at " + number(-end, "%.3g") + " and "
               + number(std::round(high) + 0.0, "%+.0f") + " % at " + number(end, "%+.3g") + " " + unit;
    }
    const auto* component = model.find(effect.id());
    if (!component)
        return "";
    auto figures = effect.summary(component->extent, valuesOf(*component).data());
    if (figures.empty())
        for (const auto& p : component->parameters)
            figures.push_back({p.name, p.unit, p.value});
    std::string text;
    for (const auto& f : figures)
        text += (text.empty() ? "" : ", ") + f.name + " = " + number(f.value, "%.3g") + (f.unit == "1" ? "" : " " + f.unit);
    return "it comes out with " + text;
}

} // namespace

std::string reasonFor(const Effect& effect, const Model& with, const Comparison& before,
                      const std::map<Quantity, double>& errorDbAfter)
{
    const auto& channel = worst(before);
    std::string text;
    if (const auto after = errorDbAfter.find(channel.quantity); after != errorDbAfter.end()) {
        text = "With it the " + titleOf(channel) + " error goes from " + number(channel.total.db) + " to "
               + number(after->second) + " dB";
        if (channel.total.noiseFloorDb)
            text += " (noise " + number(*channel.total.noiseFloorDb) + " dB)";
        text += "; ";
    }
    if (const auto shape = law(with, effect, isAnalogue(before)); !shape.empty())
        text += shape + "; ";
    text += "look for " + effect.symptoms();
    if (const auto kinds = parity(channel); !kinds.empty())
        text += "; the error before: " + kinds;
    return text + ".";
}

std::string signatureOf(const Comparison& comparison)
{
    const auto& channel = worst(comparison);
    std::string text = titleOf(channel) + " error at " + number(channel.total.db) + " dB";
    if (channel.total.noiseFloorDb)
        text += " over noise at " + number(*channel.total.noiseFloorDb) + " dB";
    if (!channel.spectrumByLevel.empty() && !channel.spectrumByLevel.back().frequency.empty()) {
        // The band that holds the middle 80 percent of the error's power.
        const auto& s = channel.spectrumByLevel.back();
        double total = 0.0, sum = 0.0, low = s.frequency.front(), high = s.frequency.back();
        for (const double e : s.error)
            total += e * e;
        bool lowSet = false;
        for (std::size_t k = 0; k < s.error.size(); ++k) {
            sum += s.error[k] * s.error[k];
            if (!lowSet && sum > 0.1 * total) {
                low = s.frequency[k];
                lowSet = true;
            }
            if (sum > 0.9 * total) {
                high = s.frequency[k];
                break;
            }
        }
        text += ", mostly from " + frequency(low) + " to " + frequency(high);
    }
    if (const auto kinds = parity(channel); !kinds.empty())
        text += "; " + kinds;
    if (channel.byLevel.size() > 1 && comparison.levels.front() > 0.0) {
        // Relative error against level: distortion of order n grows by n - 1 dB a dB.
        const double decibels = 20.0 * std::log10(comparison.levels.back() / comparison.levels.front());
        text += "; it grows by " + number((channel.byLevel.back().db - channel.byLevel.front().db) / decibels, "%.2f") + " dB a dB of level";
    }
    return text;
}

} // namespace excursion
