// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plots/ModelPlots.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace excursion {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

/// lambda of a pole or zero: ln z in discrete time.
Complex lambdaOf(Complex root, const StateSpace& model)
{
    return model.continuous() ? root : model.sampleRate * std::log(root);
}

double frequencyOf(Complex lambda, double alpha) { return std::pow(std::abs(lambda), 1.0 / alpha) / (2.0 * pi); }

/// The frequencies over which a loudspeaker's model has something to tell: up to a decade around its poles below 100
/// kHz, within the Nyquist frequency. Poles beyond stand for what a fit could not resolve.
std::array<double, 2> bandOf(const StateSpace& model, double alpha)
{
    double low = std::numeric_limits<double>::infinity(), high = 0.0;
    for (const auto pole : poles(model)) {
        const double f = frequencyOf(lambdaOf(pole, model), alpha);
        if (f > 0.0 && f < 1e5) {
            low = std::min(low, f);
            high = std::max(high, f);
        }
    }
    if (!(low < high * 10.0)) {
        low = 100.0;
        high = 1000.0;
    }
    low = std::max(low / 10.0, 0.1);
    high = std::min(high * 10.0, model.continuous() ? 1e5 : 0.49 * model.sampleRate);
    return {std::min(low, high / 10.0), high};
}

/// Single points: a gap behind each keeps them apart.
Series points(const std::string& title, Role role, const std::vector<Complex>& roots, const StateSpace& model,
              double alpha)
{
    Series series {title, role, {}, {}, {}, {}, Series::Shape::pointsAndLine, 0};
    for (const auto root : roots) {
        const auto lambda = lambdaOf(root, model);
        const double f = frequencyOf(lambda, alpha);
        if (!(f > 0.0) || !std::isfinite(f) || lambda.imag() < 0.0)
            continue;  // the conjugate is there
        series.x.insert(series.x.end(), {f, std::numeric_limits<double>::quiet_NaN()});
        series.y.insert(series.y.end(),
                        {std::abs(std::arg(lambda)) * 180.0 / pi, std::numeric_limits<double>::quiet_NaN()});
    }
    return series;
}

}  // namespace

Plot rootsPlot(const StateSpace& model, double alpha)
{
    Plot plot;
    plot.title = "Poles and zeros";
    plot.x = {"frequency |s|/2\u03c0", "Hz", true, 0.0, 0.0, {}};
    plot.y = {"angle", "\u00b0", false, 0.0, 190.0, {}};
    plot.series.push_back(points("poles", Role::model, poles(model), model, alpha));
    if (model.inputs() == model.outputs())
        plot.series.push_back(points("zeros", Role::error, zeros(model), model, alpha));
    const auto band = bandOf(model, alpha);
    plot.x.least = band[0];
    plot.x.most = band[1];
    plot.series.push_back({"border of stability",
                           Role::reference,
                           {band[0], band[1]},
                           {90.0 * alpha, 90.0 * alpha},
                           {},
                           {},
                           Series::Shape::line,
                           0});
    return plot;
}

Plot gainSurfacePlot(const StateSpace& model, double alpha)
{
    Plot plot;
    plot.title = "Gain surface, cut along rays";
    plot.x = {"|s|/2\u03c0", "Hz", true, 0.0, 0.0, {}};
    plot.y = {"gain", "dB", false, 0.0, 0.0, {}};
    const auto n = model.order();
    const auto band = bandOf(model, alpha);
    constexpr int count = 240;
    const std::array<std::pair<double, Role>, 4> rays {
        {{90.0, Role::model}, {105.0, Role::after}, {135.0, Role::error}, {180.0, Role::noise}}};
    for (const auto& [degrees, role] : rays) {
        std::array<char, 32> title {};
        std::snprintf(title.data(), title.size(), "%.0f\u00b0", degrees);
        Series series {title.data(), role, {}, {}, {}, {}, Series::Shape::line, 0};
        for (int k = 0; k <= count; ++k) {
            const double f = band[0] * std::pow(band[1] / band[0], static_cast<double>(k) / count);
            const Complex s = std::polar(2.0 * pi * f, degrees * pi / 180.0);
            const Complex lambda = model.continuous() ? std::pow(s, alpha) : std::exp(s / model.sampleRate);
            Eigen::MatrixXcd M = -model.A.cast<Complex>();
            M.diagonal().array() += lambda;
            const Complex G =
                (model.C.row(0).cast<Complex>() * M.partialPivLu().solve(model.B.col(0).cast<Complex>())).value()
                + model.D(0, 0);
            series.x.push_back(f);
            series.y.push_back(n > 0 || std::abs(G) > 0.0 ? 20.0 * std::log10(std::max(std::abs(G), 1e-15))
                                                          : std::numeric_limits<double>::quiet_NaN());
        }
        plot.series.push_back(std::move(series));
    }
    return plot;
}

Plot orderPlot(const ErrorsByOrder& errors)
{
    Plot plot;
    plot.title = "Error against order";
    plot.x = {"order", "", false, 0.0, 0.0, {}};
    plot.y = {"error", "dB", false, 0.0, 0.0, {}};
    const auto add = [&](const char* title, Role role, const std::vector<double>& y) {
        if (std::any_of(y.begin(), y.end(), [](double value) { return std::isfinite(value); }))
            plot.series.push_back({title, role, errors.order, y, {}, {}, Series::Shape::pointsAndLine, 0});
    };
    add("on the data", Role::model, errors.error);
    add("weighted", Role::error, errors.weighted);
    add("on validation data", Role::measured, errors.validation);
    return plot;
}

}  // namespace excursion
