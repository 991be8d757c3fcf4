// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plots/IdentifiedPlots.h"

#include "Engine/Document/Engineering.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace excursion {
namespace {

constexpr double gap = std::numeric_limits<double>::quiet_NaN();

double inDb(double magnitude) { return magnitude > 0.0 ? 20.0 * std::log10(magnitude) : gap; }

Series drawn(const char* title, Role role, Series::Shape shape = Series::Shape::line)
{
    return {title, role, {}, {}, {}, {}, shape, 0};
}

/// A gap behind each keeps single points apart.
Series rootsOf(const char* title, Role role, const std::vector<std::complex<double>>& roots, double scale)
{
    auto series = drawn(title, role, Series::Shape::pointsAndLine);
    for (const auto& root : roots) {
        series.x.insert(series.x.end(), {root.real() / scale, gap});
        series.y.insert(series.y.end(), {root.imag() / scale, gap});
    }
    return series;
}

double reachOf(const std::vector<std::complex<double>>& roots)
{
    double reach = 0.0;
    for (const auto& root : roots)
        reach = std::max(reach, std::abs(root));
    return reach;
}

}  // namespace

Plot gainPlot(const Frf& measured, const Frf& model, const std::string& unit)
{
    Plot plot;
    plot.title = "Gain";
    plot.x = {"frequency", "Hz", true, 0.0, 0.0, {}};
    plot.y = {"dB re 1\u202f" + typesetUnit(unit), "", false, 0.0, 0.0, {}};
    auto was = drawn("measured", Role::measured), is = drawn("model", Role::model), left = drawn("error", Role::error),
         noise = drawn("deviation", Role::noise);
    const auto& variance = measured.totalVariance.empty() ? measured.noiseVariance : measured.totalVariance;
    for (std::size_t k = 0; k < measured.frequency.size(); ++k) {
        for (auto* series : {&was, &is, &left, &noise})
            series->x.push_back(measured.frequency[k]);
        was.y.push_back(inDb(std::abs(measured.value[k])));
        is.y.push_back(inDb(std::abs(model.value[k])));
        left.y.push_back(inDb(std::abs(measured.value[k] - model.value[k])));
        noise.y.push_back(variance.empty() ? gap : inDb(std::sqrt(variance[k])));
    }
    if (!variance.empty())
        plot.series.push_back(std::move(noise));
    plot.series.push_back(std::move(left));
    plot.series.push_back(std::move(was));
    plot.series.push_back(std::move(is));
    return plot;
}

Plot phasePlot(const Frf& measured, const Frf& model)
{
    Plot plot;
    plot.title = "Phase";
    plot.x = {"frequency", "Hz", true, 0.0, 0.0, {}};
    plot.y = {"phase", "\u00b0", false, -190.0, 190.0, {}};
    plot.key = false;
    for (const auto& [frf, title, role] :
         {std::tuple(&measured, "measured", Role::measured), std::tuple(&model, "model", Role::model)}) {
        auto series = drawn(title, role);
        double before = gap;
        for (std::size_t k = 0; k < frf->frequency.size(); ++k) {
            const double degrees = std::arg(frf->value[k]) * 180.0 / std::numbers::pi;
            if (std::abs(degrees - before) > 180.0) {
                series.x.push_back(frf->frequency[k]);
                series.y.push_back(gap);
            }
            series.x.push_back(frf->frequency[k]);
            series.y.push_back(degrees);
            before = degrees;
        }
        plot.series.push_back(std::move(series));
    }
    return plot;
}

Plot rootsPlanePlot(const StateSpace& model, double alpha)
{
    const auto found = poles(model);
    const auto absent = model.inputs() == model.outputs() ? zeros(model) : std::vector<std::complex<double>> {};
    Plot plot;
    auto border = drawn("border of stability", Role::reference);
    double scale = 1.0;
    if (model.continuous()) {
        const auto power = alpha == 1.0 ? std::string() : "^\u03b1";
        plot.title = "Poles and zeros, " + std::string(alpha == 1.0 ? "s" : "\u03bb = s^\u03b1");
        plot.x = {"real part", alpha == 1.0 ? "1000 rad/s" : "(1000 rad/s)" + power, false, 0.0, 0.0, {}};
        scale = std::pow(1000.0, alpha);
        // The frequencies within which poles lie: zeros may be far off.
        const double reach = 1.15 * std::max(reachOf(found), 1e-9) / scale, angle = alpha * std::numbers::pi / 2.0;
        for (const double sign : {1.0, -1.0}) {
            border.x.insert(border.x.end(), {0.0, 2.0 * reach * std::cos(angle), gap});
            border.y.insert(border.y.end(), {0.0, sign * 2.0 * reach * std::sin(angle), gap});
        }
        plot.x.least = plot.y.least = -reach;
        plot.x.most = plot.y.most = reach;
    } else {
        plot.title = "Poles and zeros, z";
        plot.x = {"real part", "", false, 0.0, 0.0, {}};
        for (int k = 0; k <= 240; ++k) {
            border.x.push_back(std::cos(2.0 * std::numbers::pi * k / 240.0));
            border.y.push_back(std::sin(2.0 * std::numbers::pi * k / 240.0));
        }
        const double reach = 1.15 * std::clamp(reachOf(found), 1.0, 10.0);
        plot.x.least = plot.y.least = -reach;
        plot.x.most = plot.y.most = reach;
    }
    plot.y.title = "imaginary part";
    plot.series = {std::move(border), rootsOf("poles", Role::model, found, scale),
                   rootsOf("zeros", Role::error, absent, scale)};
    return plot;
}

Plot stepsPlot(const std::vector<double>& history, const std::optional<double>& noiseDb)
{
    Plot plot;
    plot.title = "How the error fell";
    plot.x = {"step", "", false, 0.0, std::max(3.0, static_cast<double>(history.size()) - 1.0), {}};
    plot.y = {"error", "dB", false, 0.0, 0.0, {}};
    auto error = drawn("error", Role::error, Series::Shape::pointsAndLine), noise = drawn("noise", Role::noise);
    for (std::size_t k = 0; k < history.size(); ++k) {
        error.x.push_back(static_cast<double>(k));
        error.y.push_back(history[k]);
    }
    plot.series.push_back(std::move(error));
    if (noiseDb) {
        noise.x = {0.0, plot.x.most};
        noise.y = {*noiseDb, *noiseDb};
        plot.series.push_back(std::move(noise));
    }
    return plot;
}

}  // namespace excursion
