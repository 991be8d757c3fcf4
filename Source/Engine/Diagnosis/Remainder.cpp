// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Remainder.h"

#include "Engine/Document/Figures.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace excursion {
namespace {

/// The places between which the middle 80 percent of a power lie.
std::pair<std::size_t, std::size_t> middleOf(const std::vector<double>& power)
{
    constexpr double tail = 0.1;
    const double total = std::accumulate(power.begin(), power.end(), 0.0);
    std::size_t low = 0, high = power.empty() ? 0 : power.size() - 1;
    double below = 0.0, above = 0.0;
    while (low < high && (below += power[low]) <= tail * total)
        ++low;
    while (high > low && (above += power[high]) <= tail * total)
        --high;
    return {low, high};
}

std::vector<double> squares(const std::vector<double>& values)
{
    auto power = values;
    for (auto& value : power)
        value *= value;
    return power;
}

/// The level that stands out farthest from its noise, where all together do not.
std::optional<std::size_t> levelThatStandsOut(const ChannelComparison& channel)
{
    std::optional<std::size_t> found;
    if (!isNoise(channel.total))
        return found;
    for (std::size_t k = 0; k < channel.byLevel.size(); ++k)
        if (const auto& error = channel.byLevel[k];
            error.noiseFloorDb && !isNoise(error)
            && (!found || error.chiSquaredPerValue > channel.byLevel[*found].chiSquaredPerValue))
            found = k;
    return found;
}

std::string levelInWords(std::size_t level, std::size_t count)
{
    return level == 0           ? "the lowest level"
           : level + 1 == count ? "the highest level"
                                : "level " + std::to_string(level + 1) + " of " + std::to_string(count);
}

ChannelRemainder partOf(const ChannelComparison& channel, const Comparison& comparison)
{
    ChannelRemainder part;
    part.quantity = channel.quantity;
    part.title = titleOf(channel);
    const auto alone = levelThatStandsOut(channel);
    if (alone)
        part.level = levelInWords(*alone, channel.byLevel.size());
    const auto& error = alone ? channel.byLevel[*alone] : channel.total;
    const auto there = [&](std::size_t count) { return std::min(alone.value_or(count), count - 1); };
    part.db = error.db;
    part.noiseFloorDb = error.noiseFloorDb;
    part.wanderDb = channel.wanderDb;
    if (comparison.noiseKnown)
        part.aboveNoiseDb = 10.0 * std::log10(std::max(error.chiSquaredPerValue, 1e-30));
    if (part.noiseFloorDb)
        part.repeats = std::max(0.0, 1.0 - std::pow(10.0, (*part.noiseFloorDb - part.db) / 10.0));
    if (const auto& all = channel.spectrumByLevel; !all.empty())
        if (const auto& s = all[there(all.size())]; !s.frequency.empty()) {
            const auto [low, high] = middleOf(squares(s.error));
            part.low = s.frequency[low];
            part.high = s.frequency[high];
        }
    if (const auto& all = channel.kindsByLevel; !all.empty())
        part.kinds = all[there(all.size())];
    if (channel.byLevel.size() > 1 && comparison.levels.front() > 0.0)
        part.growth = (channel.byLevel.back().db - channel.byLevel.front().db)
                      / (20.0 * std::log10(comparison.levels.back() / comparison.levels.front()));
    return part;
}

/// Share of a residual's power that its mean curve explains; every bin counts alike.
double shareOf(const ResidualCurve& curve)
{
    double explained = 0.0, all = 0.0;
    for (std::size_t k = 0; k < curve.mean.size(); ++k) {
        explained += curve.mean[k] * curve.mean[k];
        all += curve.mean[k] * curve.mean[k] + curve.scatter[k] * curve.scatter[k];
    }
    return all > 0.0 ? explained / all : 0.0;
}

/// Whether the mean stands out at one end only, as of something that is touched there.
bool oneSided(const ResidualCurve& curve)
{
    if (curve.mean.size() < 8)
        return false;
    constexpr double outer = 0.7, times = 3.0;
    double low = 0.0, high = 0.0, inside = 0.0;
    const double reach = std::min(-curve.argument.front(), curve.argument.back());
    for (std::size_t k = 0; k < curve.mean.size(); ++k) {
        const double size = std::abs(curve.mean[k]);
        auto& most = curve.argument[k] < -outer * reach ? low : curve.argument[k] > outer * reach ? high : inside;
        most = std::max(most, size);
    }
    return std::max(low, high) > times * std::max(std::min(low, high), inside);
}

const ResidualCurve* bestCurve(const Comparison& comparison, const std::string& residual)
{
    const ResidualCurve* best = nullptr;
    for (const auto& curve : comparison.residuals)
        if (curve.residual == residual && (!best || shareOf(curve) > shareOf(*best)))
            best = &curve;
    return best;
}

/// The shape in words, where it has one.
std::vector<std::string> likenessOf(const Comparison& comparison, const Remainder& remainder)
{
    for (const auto& part : remainder.channels)
        if (part.wanderDb)  // the rest may be a symptom of it
            return {"a parameter that wanders, or drifts: periods of the " + part.title
                    + " that should be equal differ by " + figure(*part.wanderDb, "%.0f")
                    + " dB of it, the more the larger it is"};
    std::vector<std::string> words;
    constexpr double mostly = 0.5, hardly = 0.25, clearly = 10.0;  // dB the last
    bool anyCurve = false;
    for (const auto& place : remainder.places) {
        if (place.db < remainder.places.front().db - clearly)
            break;  // a symptom of the larger one
        const auto& curve = *bestCurve(comparison, place.residual);
        anyCurve = anyCurve || place.share > hardly;
        if (place.share > hardly && place.against == "x" && place.residual == "force" && oneSided(curve))
            words.emplace_back(
                "contact on one side, where x is near "
                + placeText(std::abs(place.from) > std::abs(place.to) ? place.from : place.to, place.unit));
        else if (place.share > mostly)
            words.emplace_back("a " + place.residual + " that depends on " + place.against
                               + " in a way that no law of the model has");
    }
    const auto& first = remainder.channels.front();
    const auto level = [](const std::optional<double>& db) { return db.value_or(-1e3); };
    const double bent = std::max(level(first.kinds.odd), level(first.kinds.even));
    if (first.kinds.linear && *first.kinds.linear > bent + clearly) {
        if (first.high < 2.0 * first.low)
            words.emplace_back("another resonance near " + frequencyText(std::sqrt(first.low * first.high)));
        else if (!first.growth || std::abs(*first.growth) < 0.3)
            words.emplace_back("a linear part that the model lacks, or a parameter that wanders");
    } else if (!remainder.places.empty() && !anyCurve && first.kinds.odd) {
        words.emplace_back("a " + remainder.places.front().residual
                           + " with a memory, such as a hysteresis, or one that depends on two of x, v and i at once");
    }
    return words;
}

}  // namespace

Remainder remainderOf(const Comparison& comparison)
{
    Remainder remainder;
    for (const auto& channel : comparison.channels)
        remainder.channels.push_back(partOf(channel, comparison));
    std::stable_sort(remainder.channels.begin(), remainder.channels.end(), [](const auto& a, const auto& b) {
        return a.aboveNoiseDb.value_or(a.db) > b.aboveNoiseDb.value_or(b.db);
    });
    for (const char* residual : {"force", "voltage"})
        if (const auto* curve = bestCurve(comparison, residual)) {
            const auto [low, high] = middleOf(squares(curve->mean));
            remainder.places.push_back({curve->residual, curve->against, curve->againstUnit, curve->db, shareOf(*curve),
                                        curve->argument[low], curve->argument[high]});
        }
    std::stable_sort(remainder.places.begin(), remainder.places.end(),
                     [](const auto& a, const auto& b) { return a.db > b.db; });
    if (!remainder.channels.empty() && !isNoise(comparison))  // noise looks like anything
        remainder.looksLike = likenessOf(comparison, remainder);
    return remainder;
}

namespace {

std::string amountOf(const ChannelRemainder& part)
{
    return part.title + " error at " + figure(part.db) + " dB"
           + (part.noiseFloorDb ? " over noise at " + figure(*part.noiseFloorDb) + " dB" : std::string())
           + (part.level.empty() ? std::string() : " at " + part.level);
}

std::string likeness(const Remainder& remainder)
{
    std::string text;
    for (std::size_t k = 0; k < remainder.looksLike.size(); ++k)
        text += (k == 0 ? "; it looks like " : ", or ") + remainder.looksLike[k];
    return text;
}

}  // namespace

std::string inFewWords(const Remainder& remainder)
{
    return remainder.channels.empty() ? std::string() : amountOf(remainder.channels.front()) + likeness(remainder);
}

std::string inWords(const Remainder& remainder)
{
    if (remainder.channels.empty())
        return "";
    const auto& first = remainder.channels.front();
    auto text = amountOf(first);
    if (first.high > 0.0)
        text += ", mostly from " + frequencyText(first.low) + " to " + frequencyText(first.high);
    if (const auto kinds = inWords(first.kinds); !kinds.empty())
        text += "; " + kinds;
    if (first.growth)
        text += "; it grows by " + figure(*first.growth, "%.2f") + " dB a dB of level";
    return text + likeness(remainder);
}

std::string unexplained(const Remainder& remainder)
{
    const bool noiseKnown = !remainder.channels.empty() && remainder.channels.front().noiseFloorDb;
    return std::string(
               noiseKnown
                   ? "Something is left that no effect of the catalogue explains: "
                   : "No effect of the catalogue lowers the error further, and the take does not tell its noise: ")
           + inWords(remainder) + ".";
}

}  // namespace excursion
