// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/Engineering.h"
#include "Plots/Plots.h"
#include "Plots/Words.h"
#include "Report/Chapters.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

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

/// The errors of the other rungs, for a reader who asks for them.
void addOtherErrors(Plot& plot, const Ladder& ladder, std::size_t rung, Quantity quantity, std::size_t level)
{
    const auto own = plot.series.size();
    const auto& channels = ladder.rungs[rung].comparison.channels;
    const auto channel = std::find_if(channels.begin(), channels.end(),
                                      [quantity](const auto& c) { return c.quantity == quantity; });
    std::vector<std::string> titles;
    for (const auto& series : plot.series)
        titles.push_back(series.title);
    overlayErrors(plot, ladder, rung, static_cast<std::size_t>(channel - channels.begin()), level);
    for (std::size_t k = 0; k < own; ++k)
        plot.series[k].title = titles[k];
    for (auto k = own; k < plot.series.size(); ++k) {
        plot.series[k].hidden = true;
        plot.series[k].facets = {{"overlay the error of", plot.series[k].title}};
        plot.series[k].title = "error, " + plot.series[k].title;
    }
}

}  // namespace

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
                if (here == nullptr || level >= here->spectrumByLevel.size()
                    || here->spectrumByLevel[level].frequency.empty())
                    continue;
                auto plot = spectrumPlot(here->spectrumByLevel[level], here->unit);
                const double rms = level < comparison.levels.size() ? comparison.levels[level] : 0.0;
                plot.title = (rms > 0.0 ? nominal(rms, "V") + " \u00b7 " : "")
                             + (shown.size() > 1 ? (rung == 0 ? "first model" : "final model") : "model")
                             + (level < here->byLevel.size() ? " \u00b7 error " + decibels(here->byLevel[level].db)
                                                             : "");
                for (const auto& series : plot.series)
                    range.include(series.y);
                plot.facets = {{"rung", rungTitle(ladder, rung)}};
                if (rms > 0.0)
                    plot.facets["level"] = nominal(rms, "V");
                addOtherErrors(plot, ladder, rung, channel.quantity, level);
                plots.push_back(std::move(plot));
            }
        if (plots.empty())
            continue;
        if (!begun)
            page.section("Spectra");
        begun = true;
        page.subsection(capitalized(name(channel.quantity)));
        for (auto& plot : plots) {  // one scale, so that pictures can be compared at a glance
            plot.y.most = 10.0 * std::ceil(range.most / 10.0 + 0.1);
            plot.y.least = std::max(10.0 * std::floor(range.least / 10.0), plot.y.most - 140.0);
        }
        page.figures(std::move(plots), static_cast<int>(shown.size()),
                     "The error (measured minus model) should fall from left to right towards the noise; where it "
                     "stays above, something is missing there.");
    }
}

}  // namespace excursion
