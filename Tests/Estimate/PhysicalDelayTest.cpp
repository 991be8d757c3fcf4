// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/PhysicalDelay.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <complex>
#include <numbers>

using namespace excursion;

namespace {

constexpr double f0 = 40.0, w0 = 2.0 * std::numbers::pi * f0;

/// Velocity over force of m s^2 + r s + k, with a mass on a spring of its own beside the cone's.
/// @param apart   its resonance over that of the cone; 0: none
/// @param share   its mass over the cone's
Frf mobility(double apart, double share, double q, double spacing, double late)
{
    Frf frf;
    const double w1 = apart * w0;
    for (double f = spacing; f < 20.0 * f0; f += spacing) {
        const std::complex<double> s(0.0, 2.0 * std::numbers::pi * f);
        const auto part = apart > 0.0 ? share * w1 * w1 / (s * s + s * w1 / q + w1 * w1) : 0.0;
        const auto force = s * s * (1.0 + part) + 0.5 * w0 * s + w0 * w0;
        frf.frequency.push_back(f);
        frf.value.push_back(s / force * std::exp(-s * late));
        frf.noiseVariance.push_back(1e-8 * std::norm(frf.value.back()));
    }
    return frf;
}

}  // namespace

TEST_CASE("A motion that is late is told to a few microseconds, and one that is not is acquitted", "[delay]")
{
    for (const double late : {-8e-4, 1e-4, 5e-4}) {
        const auto told = motionDelay(mobility(0.0, 0.0, 1.0, 5.0, late), Quantity::velocity, MotionReference::force);
        CHECK(told.clear);
        CHECK(told.seconds == Approx(late).margin(3e-6));
    }
    // also where only a few lines are left to tell
    const auto few = motionDelay(mobility(0.0, 0.0, 1.0, 40.0, 5e-4), Quantity::velocity, MotionReference::force);
    CHECK(few.clear);
    CHECK(few.seconds == Approx(5e-4).margin(3e-6));
    const auto none = motionDelay(mobility(0.0, 0.0, 1.0, 5.0, 0.0), Quantity::velocity, MotionReference::force);
    CHECK(none.conclusive);
    CHECK_FALSE(none.clear);
}

TEST_CASE("The corner of a sensor is no delay where it can be seen, and hides none", "[delay]")
{
    for (const double corner : {5e2, 7e2, 1.2e3})
        for (const double q : {0.8, std::numbers::sqrt2, 2.0})
            for (const double late : {0.0, 2e-4, 1.5e-3}) {
                auto frf = mobility(0.0, 0.0, 1.0, 5.0, late);
                const double T = 1.0 / (2.0 * std::numbers::pi * corner);
                for (std::size_t k = 0; k < frf.value.size(); ++k) {
                    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * frf.frequency[k]);
                    frf.value[k] /= 1.0 + q * T * s + T * T * s * s;
                }
                const auto told = motionDelay(frf, Quantity::velocity, MotionReference::force);
                INFO(corner << " Hz, q " << q << ", " << late << " s late: " << told.seconds);
                CHECK(told.clear == (late > 0.0));
                CHECK(told.seconds == Approx(late).margin(1e-5 + 0.2 * late));
            }
}

TEST_CASE("A part that swings on the cone does not pass for a delay where few lines are left to tell", "[delay]")
{
    int judged = 0;
    for (const double apart : {3.0, 4.0, 5.0, 6.5})
        for (const double share : {0.1, 0.2, 0.4})
            for (const double q : {3.0, 6.0, 12.0})
                for (const double spacing : {5.0, 6.0, 7.0, 8.0}) {
                    const auto told = motionDelay(mobility(apart, share, q, spacing, 0.0), Quantity::velocity,
                                                  MotionReference::force);
                    INFO(apart << " " << share << " " << q << " " << spacing << ": " << told.seconds);
                    CHECK_FALSE(told.clear);
                    judged += told.conclusive ? 1 : 0;
                }
    CHECK(judged > 20);
}
