// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plots/Plots.h"
#include "Plots/Words.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace excursion {
namespace {

/// Even and odd together, a band at a time, dB.
std::vector<double> together(const ChannelDistortion& channel)
{
    std::vector<double> sum;
    for (std::size_t k = 0; k < channel.even.size(); ++k)
        sum.push_back(addedDb(channel.even[k], channel.odd[k]));
    return sum;
}

}  // namespace

std::vector<Plot> distortionPlots(const DistortionByEffect& distortion)
{
    constexpr std::array roles {Role::model, Role::error, Role::after, Role::before};
    constexpr double audible = -100.0, headroom = 10.0, depth = 70.0;  // dB
    std::vector<Plot> plots;
    for (std::size_t c = 0; c < distortion.whole.size(); ++c) {
        const auto& whole = distortion.whole[c];
        Plot plot;
        plot.title = capitalized(name(whole.quantity));
        plot.x = {"frequency", "Hz", true, 0.0, 0.0, {}};
        plot.y = {"distortion", "dB", false, 0.0, 0.0, {}};
        plot.series.push_back(
            {"all effects", Role::measured, whole.frequency, together(whole), {}, {}, Series::Shape::line, 0});
        const auto& loud = plot.series.front().y;
        plot.y.most = loud.empty() ? 0.0
                                   : 10.0 * std::ceil((*std::max_element(loud.begin(), loud.end()) + headroom) / 10.0);
        plot.y.least = plot.y.most - depth;
        std::vector<const EffectDistortion*> effects;
        for (const auto& effect : distortion.effects)
            if (!effect.alone.empty() && distortionDb(effect.alone[c]) > audible)
                effects.push_back(&effect);
        std::stable_sort(effects.begin(), effects.end(), [c](const auto* a, const auto* b) {
            return distortionDb(a->alone[c]) > distortionDb(b->alone[c]);
        });
        for (std::size_t k = 0; k < std::min(effects.size(), roles.size()); ++k)
            plot.series.push_back({effectTitle(effects[k]->effect),
                                   roles[k],
                                   whole.frequency,
                                   together(effects[k]->alone[c]),
                                   {},
                                   {},
                                   Series::Shape::line,
                                   0});
        plots.push_back(std::move(plot));
    }
    return plots;
}

}  // namespace excursion
