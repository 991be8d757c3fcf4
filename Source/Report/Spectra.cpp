// SPDX-License-Identifier: GPL-3.0-or-later
#include "Report/Engineering.h"
#include "Report/Sections.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace excursion {
namespace {

std::vector<double> inDecibels(const std::vector<double>& values)
{
    std::vector<double> result;
    for (const double value : values)
        result.push_back(value > 0.0 ? 20.0 * std::log10(value) : std::numeric_limits<double>::quiet_NaN());
    return result;
}

struct Range {
    double least = 1e9, most = -1e9;
    void include(const std::vector<double>& values)
    {
        for (const double value : values)
            if (std::isfinite(value)) {
                least = std::min(least, value);
                most = std::max(most, value);
            }
    }
};

const ChannelComparison* channelOf(const Comparison& comparison, Quantity quantity)
{
    for (const auto& channel : comparison.channels)
        if (channel.quantity == quantity)
            return &channel;
    return nullptr;
}

/// Rms of groups of up to four: single lines, where they are sparse, would draw a comb of excited and silent ones in which nothing is seen.
ErrorSpectrum smoothed(const ErrorSpectrum& s)
{
    const auto group = std::clamp<std::size_t>(s.frequency.size() / 20, 1, 4);   // of a few points, as an impedance may have, all are shown
    ErrorSpectrum result;
    const auto grouped = [&](const std::vector<double>& values, std::size_t begin, std::size_t end) {
        double power = 0.0;
        for (std::size_t k = begin; k < end; ++k)
            power += values[k] * values[k];
        return std::sqrt(power / static_cast<double>(end - begin));
    };
    for (std::size_t begin = 0; begin < s.frequency.size(); begin += group) {
        const auto end = std::min(begin + group, s.frequency.size());
        result.frequency.push_back(std::sqrt(s.frequency[begin] * s.frequency[end - 1]));
        for (const auto& [from, to] : {std::pair(&s.measured, &result.measured), std::pair(&s.model, &result.model),
                                       std::pair(&s.error, &result.error), std::pair(&s.noise, &result.noise)})
            if (from->size() == s.frequency.size())
                to->push_back(grouped(*from, begin, end));
    }
    return result;
}

Plot spectrumPlot(const ErrorSpectrum& spectrum, const std::string& unit)
{
    const auto s = smoothed(spectrum);
    Plot plot;
    plot.x = {"frequency", "Hz", true, 0.0, 0.0, {}};
    plot.y = {"dB re 1\u202f" + typesetUnit(unit), "", false, 0.0, 0.0, {}};
    const auto line = [&](const char* title, Role role, const std::vector<double>& values) {
        if (!values.empty())
            plot.series.push_back({title, role, s.frequency, inDecibels(values), {}, {}, Series::Shape::line, 0});
    };
    line("measured", Role::measured, s.measured);
    line("model", Role::model, s.model);
    line("error", Role::error, s.error);
    line("noise", Role::noise, s.noise);
    return plot;
}

} // namespace

void addSpectra(Page& page, const LadderFile& file)
{
    const auto& ladder = file.ladder;
    std::vector<std::size_t> shown {0};
    if (ladder.rungs.size() > 1)
        shown.push_back(ladder.rungs.size() - 1);
    bool begun = false;
    for (const auto& channel : ladder.rungs.front().comparison.channels) {
        std::vector<Plot> plots;
        Range range;
        for (std::size_t level = 0; level < channel.spectrumByLevel.size(); ++level)
            for (const auto rung : shown) {
                const auto& comparison = ladder.rungs[rung].comparison;
                const auto* here = channelOf(comparison, channel.quantity);
                if (here == nullptr || level >= here->spectrumByLevel.size() || here->spectrumByLevel[level].frequency.empty())
                    continue;
                auto plot = spectrumPlot(here->spectrumByLevel[level], here->unit);
                const double rms = level < comparison.levels.size() ? comparison.levels[level] : 0.0;
                plot.title = (rms > 0.0 ? nominal(rms, "V") + " \u00b7 " : "") + (shown.size() > 1 ? (rung == 0 ? "first model" : "final model") : "model")
                           + (level < here->byLevel.size() ? " \u00b7 error " + decibels(here->byLevel[level].db) : "");
                for (const auto& series : plot.series)
                    range.include(series.y);
                plots.push_back(std::move(plot));
            }
        if (plots.empty())
            continue;
        if (!begun)
            page.section("Spectra");
        begun = true;
        page.subsection(capitalized(name(channel.quantity)));
        for (auto& plot : plots) {   // one scale, so that pictures can be compared at a glance
            plot.y.most = 10.0 * std::ceil(range.most / 10.0 + 0.1);
            plot.y.least = std::max(10.0 * std::floor(range.least / 10.0), plot.y.most - 140.0);
        }
        page.figures(std::move(plots), static_cast<int>(shown.size()),
                     "The error (measured minus model) should fall from left to right towards the noise; where it stays above, something is missing there.");
    }
}

} // namespace excursion
