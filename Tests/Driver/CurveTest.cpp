// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/Curve.h"

#include <catch2/catch.hpp>

#include <algorithm>
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

} // namespace

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
        CHECK(worst < 1e-9);   // the monomials of degree 18 cancel to about seven digits fewer than a double has
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
        CHECK(worst < 1e-9);
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
