// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Reason.h"

#include "Engine/Document/Figures.h"
#include "Engine/Document/Words.h"
#include "Engine/Loudspeaker/Laws.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace excursion {
namespace {

constexpr double noticed = 0.5;    // dB
constexpr double flat = 3.0;       // %, of a law
constexpr double symmetric = 0.2;  // of the larger side

struct Fall {
    std::string channel;
    double by, to;
    std::optional<double> noise;
};

/// The largest first.
std::vector<Fall> fallsOf(const Comparison& before, const std::map<Quantity, double>& errorDbAfter)
{
    std::vector<Fall> falls;
    for (const auto& channel : before.channels)
        if (const auto after = errorDbAfter.find(channel.quantity); after != errorDbAfter.end())
            falls.push_back(
                {titleOf(channel), channel.total.db - after->second, after->second, channel.total.noiseFloorDb});
    std::stable_sort(falls.begin(), falls.end(), [](const Fall& a, const Fall& b) { return a.by > b.by; });
    return falls;
}

/// "a", "a and b", "a, b and c".
std::string listed(const std::vector<std::string>& words)
{
    std::string text;
    for (std::size_t k = 0; k < words.size(); ++k)
        text += (k == 0 ? "" : k + 1 == words.size() ? " and " : ", ") + words[k];
    return text;
}

/// "The displacement error falls by 27.0 dB to -55.3 dB (noise -74.2 dB), current by 1.0 dB; pressure stays."
std::string falling(const std::vector<Fall>& falls)
{
    if (falls.empty())
        return "";
    if (falls.front().by < noticed)
        return "It takes less than " + figure(noticed) + " dB off every channel. ";
    const auto& first = falls.front();
    std::string text = "The " + first.channel + " error falls by " + figure(first.by) + " dB to " + figure(first.to)
                       + " dB" + (first.noise ? " (noise " + figure(*first.noise) + " dB)" : "");
    std::vector<std::string> still, up;
    for (std::size_t k = 1; k < falls.size(); ++k) {
        const auto& fall = falls[k];
        if (fall.by >= noticed)
            text += ", " + fall.channel + " by " + figure(fall.by) + " dB";
        else if (fall.by > -noticed)
            still.push_back(fall.channel);
        else
            up.push_back(fall.channel + " by " + figure(-fall.by) + " dB");
    }
    if (!still.empty())
        text += "; " + listed(still) + (still.size() == 1 ? " stays" : " stay");
    if (!up.empty())
        text += "; " + listed(up) + (up.size() == 1 ? " rises" : " rise");
    return text + ". ";
}

/// @param low, high  %, at the ends against rest
std::string shapeOf(double low, double high)
{
    const double larger = std::max(std::abs(low), std::abs(high));
    if (larger < flat)
        return " stays nearly flat";
    if (low * high <= 0.0 || std::min(std::abs(low), std::abs(high)) < 0.1 * larger)
        return low < high ? " rises from end to end" : " falls from end to end";
    const std::string way = low > 0.0 ? " rises" : " falls";
    return way + (std::abs(low - high) <= symmetric * larger ? " to both ends alike" : " to both ends unevenly");
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
        return titleOfLaw(curve.info.name, curve.frequency) + shapeOf(low, high) + ": "
               + figure(std::round(low) + 0.0, "%+.0f") + " % at " + figure(-end, "%.3g") + " and "
               + figure(std::round(high) + 0.0, "%+.0f") + " % at " + figure(end, "%+.3g") + " " + unit;
    }
    const auto* component = model.find(effect.id());
    if (!component)
        return "";
    auto figures = effect.summary(component->operatingRange, valuesOf(*component).data());
    if (figures.empty())
        for (const auto& p : component->parameters)
            figures.push_back({p.name, p.unit, p.value});
    const auto text = joined(figures, [&](const auto& f) {
        return f.name + " = " + figure(f.value, "%.3g") + (f.unit == "1" ? "" : " " + f.unit);
    });
    return "It comes out with " + text;
}

}  // namespace

std::string reasonFor(const Effect& effect, const Model& with, const Comparison& before,
                      const std::map<Quantity, double>& errorDbAfter)
{
    auto text = falling(fallsOf(before, errorDbAfter));
    if (const auto shape = law(with, effect, isAnalogue(before)); !shape.empty())
        text += shape + ". ";
    return text + "Look for " + effect.symptoms() + ".";
}

}  // namespace excursion
