// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Collocation.h"
#include "Bench/Curve.h"
#include "Bench/Random.h"
#include "Bench/Relaxation.h"
#include "Bench/Resampling.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace excursion::bench;

TEST_CASE("the fractional integral is s^-alpha within its band", "[bench]")
{
    const double low = 2.0 * std::numbers::pi * 2.0, high = 2.0 * std::numbers::pi * 48e3;
    for (const double alpha : {0.1, 0.3, 0.45, 0.55, 0.9}) {
        const auto cells = fractionalIntegral(alpha, low, high);
        CHECK(cells.rate.size() < 45);
        double worst = 0.0;
        for (double w = low; w <= high; w *= 1.05) {
            const std::complex<double> s {0.0, w};
            worst = std::max(worst, std::abs(cells.response(s) / std::pow(s, -alpha) - 1.0));
        }
        CHECK(worst < 2e-6);
    }
}

TEST_CASE("the logarithm is its closed form everywhere", "[bench]")
{
    const auto cells = logarithm(1.0, 5000.0);
    for (double w = 0.01; w < 1e5; w *= 1.3) {
        const std::complex<double> s {0.0, w};
        CHECK(std::abs(cells.response(s) / std::log((s + 5000.0) / (s + 1.0)) - 1.0) < 1e-6);
    }
}

TEST_CASE("the collocation integrates parabolas and extrapolates quintics exactly", "[bench]")
{
    const auto& c = Radau::points();
    for (int j = 0; j < 3; ++j) {
        double once = 0.0, value = 0.0;
        for (int l = 0; l < 3; ++l)
            once += Radau::once()[j][l] * c[l] * c[l];
        CHECK(once == Approx(c[j] * c[j] * c[j] / 3.0).epsilon(1e-13));
        for (int n = 0; n < 6; ++n)
            value += Radau::extrapolation()[j][n] * std::pow(c[n % 3] - (n < 3 ? 2.0 : 1.0), 5);
        CHECK(value == Approx(std::pow(c[j], 5)).margin(1e-10));
    }
}

TEST_CASE("the decayed powers agree where series and closed form meet", "[bench]")
{
    for (const std::complex<double> direction : {std::complex<double>(1.0, 0.0), std::complex<double>(0.1, 0.9)}) {
        const auto q = direction / std::abs(direction);
        const auto series = decayedPowers(1.4999999 * q, 1.0), closed = decayedPowers(1.5000001 * q, 1.0);
        for (int p = 0; p < 3; ++p)
            CHECK(std::abs(series[p] - closed[p]) < 1e-6);
    }
    CHECK(decayedPowers(0.0, 1.0)[2].real() == Approx(1.0 / 3.0));
}

TEST_CASE("every curve has its slope, is 1 at rest and reaches the strength asked for", "[bench]")
{
    using Shape = Curve::Shape;
    for (const auto shape :
         {Shape::erfGap, Shape::logisticGap, Shape::quarticGap, Shape::gaussianGap, Shape::coshSpring, Shape::expSpring,
          Shape::rationalSpring, Shape::skewedSpring, Shape::tanhStep, Shape::arctanStep, Shape::rootStep,
          Shape::saturation, Shape::rootDrag, Shape::powerDrag, Shape::tanhDrag}) {
        INFO(name(shape));
        const double extra = shape == Shape::powerDrag ? 1.8 : shape == Shape::rationalSpring ? 0.2 : 0.9;
        for (const double strength : {0.05, 0.3, 0.6}) {
            const auto curve = Curve {shape, 0.05e-3, 1e-3, 0.5, extra}.scaledTo(strength, 2e-3);
            CHECK(curve.value(0.0) == Approx(1.0));
            CHECK(curve.change(2e-3) == Approx(strength).epsilon(1e-6));
            for (const double q : {-1.7e-3, -0.4e-3, 0.3e-3, 1.9e-3}) {
                const double h = 1e-8;
                CHECK(curve.slope(q)
                      == Approx((curve.value(q + h) - curve.value(q - h)) / (2.0 * h)).epsilon(1e-5).margin(1e-4));
            }
        }
    }
}

TEST_CASE("resampling keeps the band and rejects what would fold", "[bench]")
{
    const std::size_t length = 4000;
    const auto tone = [&](double f, int factor) {
        std::vector<double> x(length * static_cast<std::size_t>(factor));
        for (std::size_t n = 0; n < x.size(); ++n) {
            const double t = static_cast<double>(n) / factor,
                         window = std::exp(-0.5 * std::pow((t - 2000.0) / 200.0, 2));
            x[n] = window * std::cos(2.0 * std::numbers::pi * f * (t - 2000.0));
        }
        return x;
    };
    for (const double f : {0.01, 0.2, 0.41}) {
        const auto fine = tone(f, 4), coarse = tone(f, 1);
        const auto down = decimate(fine, 4, length), up = interpolate(coarse, 4, 0.0);
        double worst = 0.0;
        for (std::size_t n = 0; n < length; ++n)
            worst = std::max({worst, std::abs(down[n] - coarse[n]), std::abs(up[4 * n + 1] - fine[4 * n + 1])});
        CHECK(worst < 1e-7);
    }
    double folded = 0.0;
    for (const double value : decimate(tone(0.7, 4), 4, length))
        folded = std::max(folded, std::abs(value));
    CHECK(folded < 1e-12);
    CHECK(readBetween(tone(0.2, 4), 8001.3) == Approx(std::cos(2.0 * std::numbers::pi * 0.05 * 1.3)).epsilon(1e-5));
}

TEST_CASE("random numbers are the ones they always were", "[bench]")
{
    Random random(1);
    CHECK(random.uniform() != Random(2).uniform());
    CHECK(Random(1, 1).uniform() != Random(1, 2).uniform());
    double sum = 0.0, square = 0.0;
    for (int n = 0; n < 20000; ++n) {
        const double value = random.normal();
        sum += value;
        square += value * value;
    }
    CHECK(std::abs(sum / 20000.0) < 0.03);
    CHECK(square / 20000.0 == Approx(1.0).epsilon(0.03));
}
