// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Reason.h"

#include "Engine/Document/Figures.h"
#include "Engine/Document/Words.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

/// The channel whose error stands highest above its noise.
const ChannelComparison& worst(const Comparison& comparison)
{
    return *std::max_element(comparison.channels.begin(), comparison.channels.end(),
                             [](const auto& a, const auto& b) { return a.total.chi < b.total.chi; });
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
        return curve.info.name + " comes out " + figure(std::round(low) + 0.0, "%+.0f") + " % at "
               + figure(-end, "%.3g") + " and " + figure(std::round(high) + 0.0, "%+.0f") + " % at "
               + figure(end, "%+.3g") + " " + unit;
    }
    const auto* component = model.find(effect.id());
    if (!component)
        return "";
    auto figures = effect.summary(component->extent, valuesOf(*component).data());
    if (figures.empty())
        for (const auto& p : component->parameters)
            figures.push_back({p.name, p.unit, p.value});
    const auto text = joined(figures, [&](const auto& f) {
        return f.name + " = " + figure(f.value, "%.3g") + (f.unit == "1" ? "" : " " + f.unit);
    });
    return "it comes out with " + text;
}

}  // namespace

std::string reasonFor(const Effect& effect, const Model& with, const Comparison& before,
                      const std::map<Quantity, double>& errorDbAfter)
{
    const auto& channel = worst(before);
    std::string text;
    if (const auto after = errorDbAfter.find(channel.quantity); after != errorDbAfter.end()) {
        text = "With it the " + titleOf(channel) + " error goes from " + figure(channel.total.db) + " to "
               + figure(after->second) + " dB";
        if (channel.total.noiseFloorDb)
            text += " (noise " + figure(*channel.total.noiseFloorDb) + " dB)";
        text += "; ";
    }
    if (const auto shape = law(with, effect, isAnalogue(before)); !shape.empty())
        text += shape + "; ";
    text += "look for " + effect.symptoms();
    if (const auto kinds = channel.kindsByLevel.empty() ? std::string() : inWords(channel.kindsByLevel.back());
        !kinds.empty())
        text += "; the error before: " + kinds;
    return text + ".";
}

}  // namespace excursion
