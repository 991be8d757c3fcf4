// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/PlotScale.h"

#include "Plugin/Text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace excursion::plugin {
namespace {

constexpr std::size_t fewest = 3;

/// 1, 2, 5 or all digits of each decade within the range.
std::vector<double> digitsOfDecades(const AxisRange& range, const std::vector<int>& digits, int everyDecade)
{
    std::vector<double> values;
    for (int decade = static_cast<int>(std::floor(std::log10(range.least)));
         decade <= static_cast<int>(std::ceil(std::log10(range.most))); ++decade) {
        if (((decade % everyDecade) + everyDecade) % everyDecade != 0)
            continue;
        for (const int digit : digits)
            if (const double value = digit * std::pow(10.0, decade);
                value >= range.least * (1.0 - 1e-9) && value <= range.most * (1.0 + 1e-9))
                values.push_back(value);
    }
    return values;
}

std::vector<double> multiplesOf(double step, const AxisRange& range)
{
    std::vector<double> values;
    const double first = std::ceil(range.least / step - 1e-9), last = std::floor(range.most / step + 1e-9);
    for (double k = first; k <= last && values.size() < 1000; ++k)
        values.push_back(k == 0.0 ? 0.0 : k * step);
    return values;
}

/// 20, 500, 2k: with as many digits as it has.
juce::String frequencyText(double value)
{
    const bool thousands = value >= 1e3 && value < 1e6;
    const double shown = thousands ? value / 1e3 : value;
    return numberText(shown, std::pow(10.0, std::floor(std::log10(shown) + 1e-9))) + (thousands ? "k" : "");
}

std::vector<AxisLabel> named(const std::vector<double>& values, double step)
{
    std::vector<AxisLabel> labels;
    for (const double value : values)
        labels.push_back({value, step > 0.0 ? numberText(value, step) : frequencyText(value)});
    return labels;
}

/// What may be shown, the densest first.
std::vector<std::vector<AxisLabel>> choices(const AxisRange& range)
{
    std::vector<std::vector<AxisLabel>> all;
    if (range.logarithmic) {
        for (const auto& digits : {std::vector {1, 2, 5}, std::vector {1, 3}, std::vector {1}})
            all.push_back(named(digitsOfDecades(range, digits, 1), 0.0));
        for (const int every : {2, 3, 5, 10})
            all.push_back(named(digitsOfDecades(range, {1}, every), 0.0));
        if (all.front().size() >= fewest)
            return all;
        all.clear();  // less than a decade: equal steps tell more
    }
    const double span = range.most - range.least;
    for (int decade = static_cast<int>(std::floor(std::log10(span))) - 2, last = decade + 3; decade <= last; ++decade)
        for (const double digit : {1.0, 2.0, 5.0}) {
            const double step = digit * std::pow(10.0, decade);
            if (span / step < 60.0)
                all.push_back(named(multiplesOf(step, range), step));
        }
    return all;
}

}  // namespace

double AxisRange::share(double value) const
{
    return logarithmic ? std::log(value / least) / std::log(most / least) : (value - least) / (most - least);
}

double AxisRange::value(double share) const
{
    return logarithmic ? least * std::pow(most / least, share) : least + share * (most - least);
}

AxisRange AxisRange::part(double from, double to) const
{
    const AxisRange result {value(from), value(to), logarithmic};
    const double size = std::max(std::abs(result.least), std::abs(result.most));
    return result.most - result.least > 1e-6 * size ? result : *this;
}

AxisRange rangeOf(const Plot& plot, bool across)
{
    const auto& axis = across ? plot.x : plot.y;
    AxisRange range {axis.least, axis.most, axis.logarithmic};
    if (axis.least < axis.most)
        return range;
    range.least = std::numeric_limits<double>::infinity();
    range.most = -range.least;
    const auto include = [&](const std::vector<double>& values) {
        for (const double value : values)
            if (std::isfinite(value) && (!axis.logarithmic || value > 0.0)) {
                range.least = std::min(range.least, value);
                range.most = std::max(range.most, value);
            }
    };
    for (const auto& series : plot.series) {
        include(across ? series.x : series.y);
        if (!across) {
            include(series.lower);
            include(series.upper);
        }
    }
    if (!(range.least <= range.most))
        return {axis.logarithmic ? 0.1 : 0.0, 1.0, axis.logarithmic};
    if (const double size = std::max(std::abs(range.least), std::abs(range.most));
        range.most - range.least <= 1e-9 * size || range.least == range.most) {
        const double room = size > 0.0 ? 0.5 * size : 1.0;
        range = axis.logarithmic ? AxisRange {range.least / 2.0, range.most * 2.0, true}
                                 : AxisRange {range.least - room, range.most + room, false};
    }
    if (!across && !axis.logarithmic) {
        const double room = 0.06 * (range.most - range.least);
        range.least -= room;
        range.most += room;
    }
    return range;
}

juce::String numberText(double value, double step)
{
    const double size = std::max(std::abs(value), step);
    const auto place = [](double number) { return static_cast<int>(std::floor(std::log10(number) + 1e-9)); };
    const int decimals = std::max(0, -place(step));
    juce::String text;
    if (size >= 1e6 || (decimals > 4 && size < 1e-2)) {
        std::array<char, 40> buffer {};
        std::snprintf(buffer.data(), buffer.size(), "%.*e", std::clamp(place(size) - place(step), 0, 12), value);
        const auto parts = juce::StringArray::fromTokens(buffer.data(), "e", "");
        text = value == 0.0 ? juce::String("0") : parts[0] + "e" + juce::String(parts[1].getIntValue());
    } else {
        text = decimals == 0 ? whole(value) : juce::String(value, std::min(decimals, 12));
    }
    return text.replaceCharacter('-', 0x2212);
}

std::vector<AxisLabel> labelsOf(const AxisRange& range, float length,
                                const std::function<float(const juce::String&)>& extent, float gap)
{
    if (!(range.least < range.most) || !std::isfinite(range.most - range.least))
        return {};
    const auto fits = [&](const std::vector<AxisLabel>& labels, float apart) {
        for (std::size_t k = 1; k < labels.size(); ++k) {
            const double share = range.share(labels[k].value) - range.share(labels[k - 1].value);
            if (static_cast<float>(share) * length
                < 0.5f * (extent(labels[k].text) + extent(labels[k - 1].text)) + apart)
                return false;
        }
        return true;
    };
    const auto all = choices(range);
    for (const float apart : {gap, 0.25f * gap})  // closer where the room is short
        for (const auto& labels : all)
            if (labels.size() >= fewest && fits(labels, apart))
                return labels;
    // No step leaves three that stand apart: three of the sparsest, equally far from each other.
    const std::vector<AxisLabel>* sparsest = nullptr;
    for (const auto& labels : all)
        if (labels.size() >= fewest && (sparsest == nullptr || labels.size() <= sparsest->size()))
            sparsest = &labels;
    if (sparsest == nullptr)
        return all.empty() ? std::vector<AxisLabel> {} : all.front();
    const auto step = (sparsest->size() - 1) / 2;
    return {(*sparsest)[0], (*sparsest)[step], (*sparsest)[2 * step]};
}

}  // namespace excursion::plugin
