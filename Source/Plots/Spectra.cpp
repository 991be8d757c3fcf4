// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/Engineering.h"
#include "Plots/Plots.h"
#include "Plots/Words.h"

#include <algorithm>
#include <cmath>
#include <limits>
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

/// Rms of groups of up to four: single lines, where they are sparse, would draw a comb of excited and silent ones in
/// which nothing is seen.
ErrorSpectrum smoothed(const ErrorSpectrum& s)
{
    // of a few points, as an impedance may have, all are shown
    const auto group = std::clamp<std::size_t>(s.frequency.size() / 20, 1, 4);
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

}  // namespace

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

void overlayErrors(Plot& plot, const Ladder& ladder, std::size_t shown, std::size_t channel, std::size_t level)
{
    constexpr int firstDash = 2, dashes = 4;
    for (auto& series : plot.series)
        if (series.role == Role::error)
            series.title = "error at " + rungTitle(ladder, shown);
    int other = 0;
    for (std::size_t k = 0; k < ladder.rungs.size(); ++k) {
        const auto& channels = ladder.rungs[k].comparison.channels;
        if (k == shown || channel >= channels.size() || level >= channels[channel].spectrumByLevel.size())
            continue;
        const auto s = smoothed(channels[channel].spectrumByLevel[level]);
        plot.series.push_back({rungTitle(ladder, k),
                               Role::before,
                               s.frequency,
                               inDecibels(s.error),
                               {},
                               {},
                               Series::Shape::line,
                               firstDash + other++ % dashes});
    }
}

}  // namespace excursion
