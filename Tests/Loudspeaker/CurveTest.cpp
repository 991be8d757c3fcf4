// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Curve.h"
#include "Engine/Loudspeaker/Laws.h"
#include "Engine/Loudspeaker/Model.h"
#include "Loudspeaker/EffectBench.h"

#include <Eigen/QR>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace excursion;

namespace {

/// Coefficients with a one at degree k of n.
std::vector<double> unit(int n, int k)
{
    std::vector<double> c(static_cast<std::size_t>(n), 0.0);
    c[static_cast<std::size_t>(k) - 1] = 1.0;
    return c;
}

curve::ValueAndSlope<double> evaluate(int n, const std::vector<double>& c, double q, double range)
{
    std::vector<double> b(static_cast<std::size_t>(n) + 1);
    curve::prepare(n, c.data(), b.data());
    return curve::at(n, b.data(), q, range);
}

constexpr double range = 3.7e-3;

/// Monomials of degree 18 cancel to about seven digits fewer than a double has, and those of each higher one to 1 +
/// 2^1/2 times as much. A law's coefficients of such degrees are less than a thousandth of it.
double rounding(int degree) { return 1e-9 * std::pow(1.0 + std::numbers::sqrt2, std::max(0, degree - 18)); }

}  // namespace

TEST_CASE("A law's basis is zero at rest", "[curve]")
{
    for (int n = 1; n <= curve::maximumDegree; ++n)
        for (int k = 1; k <= n; ++k)
            CHECK(curve::valueAt(n, unit(n, k).data(), 0.0, range) == 0.0);
}

TEST_CASE("A law's basis is the cosine form of the Chebyshev polynomials, less their value at rest", "[curve]")
{
    for (int k = 1; k <= curve::maximumDegree; ++k) {
        double worst = 0.0;
        for (double s = -1.0; s <= 1.0; s += 1.0 / 64.0) {
            const double truth = std::cos(k * std::acos(s)) - std::cos(0.5 * k * std::numbers::pi);
            worst = std::max(worst, std::abs(curve::valueAt(k, unit(k, k).data(), s * range, range) - truth));
        }
        CHECK(worst < rounding(k));
    }
}

TEST_CASE("A law's slope is the derivative of the Chebyshev polynomials", "[curve]")
{
    for (int k = 1; k <= curve::maximumDegree; ++k) {
        double worst = 0.0;
        for (double angle = 0.05; angle < 3.1; angle += 0.05) {
            const double truth = k * std::sin(k * angle) / std::sin(angle) / range;
            const double slope = evaluate(k, unit(k, k), std::cos(angle) * range, range).slope;
            worst = std::max(worst, std::abs(slope - truth) * range / (k * k));
        }
        CHECK(worst < rounding(k));
    }
}

TEST_CASE("A law stays at its end value beyond the range that was visited", "[curve]")
{
    const std::vector<double> c {0.3, -0.7, 0.2, 0.05};
    for (const double side : {-1.0, 1.0}) {
        const auto end = evaluate(4, c, side * range, range);
        for (const double factor : {1.0001, 1.5, 1e3}) {
            const auto beyond = evaluate(4, c, side * factor * range, range);
            CHECK(beyond.value == Approx(end.value).epsilon(1e-14));
            CHECK(beyond.slope == 0.0);
        }
    }
}

TEST_CASE("The band of a law is that of all its coefficients, also where it is not linear in them", "[curve]")
{
    for (const auto* effect : catalogue()) {
        if (!effect->law())
            continue;
        auto model = withEffect(makeModel("electrodynamic"), *effect, someOperatingRange(1.0));
        auto& component = model.components.back();
        double share = 0.1;
        for (auto& p : component.parameters)
            p.value = std::clamp((share *= -0.9) * (p.strength ? component.operatingRange.scale : 1.0), p.lower,
                                 p.upper);
        const auto first = static_cast<Eigen::Index>(model.base().parameters.size());
        const auto count = static_cast<Eigen::Index>(parametersOf(model).size());
        const auto at = [&](std::size_t moved, double by, double q) {
            std::vector<double> values;
            for (const auto& p : component.parameters)
                values.push_back(p.value);
            values[moved] += by;
            return effect->lawAt(component.operatingRange, values.data(), q);
        };
        for (std::size_t k = 0; k < component.parameters.size(); ++k) {
            INFO(effect->id() << ", " << component.parameters[k].name);
            const double deviation = 1e-3
                                     * std::max(std::abs(component.parameters[k].value),
                                                1e-2 * component.operatingRange.scale);
            model.covariance = Eigen::MatrixXd::Zero(count, count);
            model.covariance(first + static_cast<Eigen::Index>(k), first + static_cast<Eigen::Index>(k)) = deviation
                                                                                                           * deviation;
            for (const auto& curve : laws(model, 11)) {
                const double largest = *std::max_element(curve.halfWidth.begin(), curve.halfWidth.end());
                for (std::size_t n = 0; n < curve.argument.size(); ++n) {
                    const double step = 1e-3 * deviation, q = curve.argument[n];
                    const double rounding = 1e-12 * std::abs(curve.value[n]);  // over a thousandth of a deviation
                    const double slope = (at(k, step, q) - at(k, -step, q)) / (2.0 * step);
                    CHECK(std::abs(curve.halfWidth[n] - 1.96 * std::abs(slope) * deviation)
                          <= 1e-4 * largest + rounding);
                }
            }
        }
    }
}

TEST_CASE("A law's band is not that of parameters on which it does not depend, and unknown where its own are",
          "[curve]")
{
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    auto model = withEffect(makeModel("electrodynamic"), effectNamed("stiffness"), someOperatingRange(1.0));
    model = withEffect(std::move(model), effectNamed("eddy-currents"), someOperatingRange(1.0));
    const auto count = static_cast<Eigen::Index>(parametersOf(model).size());
    const auto first = static_cast<Eigen::Index>(model.base().parameters.size());
    const auto other = first + static_cast<Eigen::Index>(model.components[1].parameters.size());
    model.covariance = Eigen::MatrixXd::Identity(count, count);
    const auto before = laws(model).front().halfWidth;
    model.covariance(other, other) = unknown;
    CHECK(before.front() > 0.0);
    CHECK(laws(model).front().halfWidth == before);
    model.covariance(first, first) = unknown;
    CHECK(std::isnan(laws(model).front().halfWidth.front()));
}

TEST_CASE("Rms(v) is the cosine form of the Chebyshev polynomials over the rounded speed, at every degree", "[curve]")
{
    const auto& effect = effectNamed("damping-velocity");
    OperatingRange visited;
    visited.velocity = 0.7;
    constexpr double e = 0.02;  // what rounds the speed at rest
    for (int n = 1; n <= curve::maximumDegree; ++n) {
        visited.degree = n;
        auto parameters = effect.parameters(visited);
        std::vector<double> values(parameters.size(), 0.0);
        values[static_cast<std::size_t>(n) - 1] = 1.0;  // c_n alone
        double worst = 0.0;
        for (double w = -1.0; w <= 1.0; w += 1.0 / 64.0) {
            const double y = std::clamp(2.0 * (std::sqrt(w * w + e * e) - e) - 1.0, -1.0, 1.0),
                         truth = std::cos(n * std::acos(y)) - std::cos(n * std::numbers::pi);
            worst = std::max(worst, std::abs(effect.lawAt(visited, values.data(), w * visited.velocity) - truth));
        }
        INFO("degree " << n << ": " << worst);
        CHECK(worst < rounding(n));
    }
}

TEST_CASE("Rms(v) follows a vent that resists otherwise from its other side", "[curve]")
{
    const auto& effect = effectNamed("damping-velocity");
    OperatingRange visited;
    visited.velocity = 0.7;
    visited.degree = 8;
    const auto count = effect.parameters(visited).size();
    constexpr int points = 400;
    for (const double side : {0.2, 0.35, 0.5}) {
        // What of a force (1 + 1.5 (sqrt(w^2 + d^2) - d) + 0.3 w/sqrt(w^2 + side^2)) w no coefficients give: those of
        // the law and of a constant.
        Eigen::MatrixXd A(points, static_cast<Eigen::Index>(count) + 1);
        Eigen::VectorXd force(points);
        constexpr double d = 0.13;
        for (int n = 0; n < points; ++n) {
            const double w = -1.0 + (2.0 * n + 1.0) / points;
            force[n] = w * (1.0 + 1.5 * (std::hypot(w, d) - d) + 0.3 * w / std::hypot(w, side));
            A(n, 0) = w;
            for (std::size_t k = 0; k < count; ++k) {
                std::vector<double> values(count, 0.0);
                if (effect.parameters(visited)[k].name != "centre")
                    values[k] = 1.0;
                A(n, static_cast<Eigen::Index>(k) + 1) = w * effect.lawAt(visited, values.data(), w * visited.velocity);
            }
        }
        const Eigen::VectorXd left = force - A * A.completeOrthogonalDecomposition().solve(force);
        INFO("sides part within " << side);
        CHECK(20.0 * std::log10(left.norm() / force.norm()) < -60.0);
    }
}
