// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plots/VolterraPlots.h"

#include "Engine/Document/Engineering.h"

#include <algorithm>
#include <array>

namespace excursion {
namespace {

using Eigen::Index;

constexpr Index cuts = 5;

double millisecondsOf(Index samples, double sampleRate) { return 1e3 * static_cast<double>(samples) / sampleRate; }

Plot kernelPlot(const std::string& title, const std::string& what, const std::string& unit)
{
    Plot plot;
    plot.title = title;
    plot.x = {"time since the last impulse", "ms", false, 0.0, 0.0, {}};
    plot.y = {what, unit, false, 0.0, 0.0, {}};
    return plot;
}

}  // namespace

Plot firstKernelPlot(const Eigen::VectorXd& first, double sampleRate, const std::string& unit)
{
    auto plot = kernelPlot("First kernel", "h1(t)", unit);
    plot.key = false;
    Series series {"h1", Role::model, {}, {}, {}, {}, Series::Shape::line, 0};
    for (Index t = 0; t < first.size(); ++t) {
        series.x.push_back(millisecondsOf(t, sampleRate));
        series.y.push_back(first[t]);
    }
    plot.series.push_back(std::move(series));
    return plot;
}

Plot secondKernelPlot(const Eigen::MatrixXd& second, double sampleRate, const std::string& unit)
{
    auto plot = kernelPlot("Second kernel, along diagonals", "h2(t, t + s)", unit);
    constexpr std::array roles {Role::model, Role::error, Role::after, Role::before, Role::measured};
    const auto apart = std::max<Index>(1, second.rows() / (2 * cuts));
    for (Index cut = 0; cut < cuts && cut * apart < second.rows(); ++cut) {
        const auto s = cut * apart;
        Series series {"s = " + fixedText(millisecondsOf(s, sampleRate), 2) + " ms",
                       roles[static_cast<std::size_t>(cut)],
                       {},
                       {},
                       {},
                       {},
                       Series::Shape::line,
                       0};
        for (Index t = 0; t + s < second.rows(); ++t) {
            series.x.push_back(millisecondsOf(t, sampleRate));
            series.y.push_back(second(t, t + s));
        }
        plot.series.push_back(std::move(series));
    }
    return plot;
}

}  // namespace excursion
