// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plots/HarmonicPlots.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace excursion {

Plot harmonicPlot(const std::string& title, const std::vector<double>& frequency,
                  const std::vector<HarmonicLine>& harmonics, const std::vector<double>& totalDb,
                  const std::vector<double>& floorDb)
{
    Plot plot;
    plot.title = title;
    plot.x = {"frequency of the fundamental", "Hz", true, 0.0, 0.0, {}};
    plot.y = {"re the fundamental", "dB", false, 0.0, 0.0, {}};
    const auto add = [&](const std::string& name, Role role, const std::vector<double>& db, int dash) {
        if (std::any_of(db.begin(), db.end(), [](double value) { return std::isfinite(value); }))
            plot.series.push_back({name, role, frequency, db, {}, {}, Series::Shape::line, dash});
    };
    add("THD", Role::measured, totalDb, 0);
    constexpr std::array roles {Role::model, Role::error, Role::after, Role::before};
    for (const auto& harmonic : harmonics) {
        const auto index = static_cast<std::size_t>(std::max(harmonic.order - 2, 0));
        add("H" + std::to_string(harmonic.order), roles[index % roles.size()], harmonic.db,
            static_cast<int>(index / roles.size()));
    }
    add("noise may look like", Role::noise, floorDb, 0);
    return plot;
}

}  // namespace excursion
