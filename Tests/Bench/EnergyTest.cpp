// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Simulator.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <numbers>

using namespace excursion::bench;

namespace {

double integral(double to, const std::function<double(double)>& f)
{
    constexpr int count = 2000;  // Simpson
    double sum = f(0.0) + f(to);
    for (int n = 1; n < count; ++n)
        sum += (n % 2 ? 4.0 : 2.0) * f(to * n / count);
    return sum * to / (3.0 * count);
}

// Plays a burst and stops while everything moves: returns (energy in - lost - stored) / energy in.
double imbalance(const Loudspeaker& speaker)
{
    const double h = 2e-6, end = 0.0503;
    Simulator simulator(speaker, h, 2.0 * std::numbers::pi * 24e3, 2.0 * std::numbers::pi);
    const auto voltage = [](double t) {
        return 14.0 * std::pow(std::sin(std::min(t, 0.02) * std::numbers::pi / 0.04), 2)
                   * std::sin(2.0 * std::numbers::pi * 55.0 * t)
               + 6.0 * std::pow(std::sin(std::min(t, 0.02) * std::numbers::pi / 0.04), 2)
                     * std::sin(2.0 * std::numbers::pi * 730.0 * t);
    };
    double in = 0.0, lost = 0.0, work = 0.0, heat = 0.0;
    const auto steps = static_cast<int>(end / h);
    for (int n = 0; n < steps; ++n) {
        const double t = n * h;
        Triple u {};
        for (int j = 0; j < 3; ++j)
            u[j] = voltage(t + h * Radau::points()[j]);
        const auto& s = simulator.step(u);
        const double workNow = u[2] * s.current;
        const double heatNow = speaker.Re * s.current * s.current
                               + speaker.dampingAt(s.velocity) * s.velocity * s.velocity;
        in += 0.5 * h * (work + workNow);
        lost += 0.5 * h * (heat + heatNow);
        work = workNow;
        heat = heatNow;
    }
    const auto& s = simulator.sample();
    const double flux = speaker.inductanceAt(s.displacement, s.current) * s.current;
    const double coEnergy = integral(s.current, [&](double i) { return speaker.inductanceAt(s.displacement, i) * i; });
    const double stored = 0.5 * speaker.m * s.velocity * s.velocity + flux * s.current - coEnergy
                          + integral(s.displacement, [&](double x) { return speaker.stiffnessAt(x) * x; });
    CHECK(stored > 1e-3 * in);
    return (in - lost - stored) / in;
}

}  // namespace

TEST_CASE("energy in is energy lost and stored, whatever the laws", "[bench]")
{
    Loudspeaker speaker;
    CHECK(std::abs(imbalance(speaker)) < 1e-7);
    speaker.forceFactor = Curve {Curve::Shape::erfGap, 0.5e-3, 3e-3, 0.0, 1.0};
    speaker.stiffness = Curve {Curve::Shape::skewedSpring, 0.5e-3, 3e-3, 0.0, 0.5};
    speaker.dampingVelocity = Curve {Curve::Shape::rootDrag, 0.0, 0.3, 1.0, 0.0};
    CHECK(std::abs(imbalance(speaker)) < 1e-7);
    speaker.Le = 3e-3;  // so that the reluctance force does real work
    speaker.inductancePosition = Curve {Curve::Shape::arctanStep, 0.5e-3, 2e-3, 0.6, 0.0};
    CHECK(std::abs(imbalance(speaker)) < 1e-7);
    speaker.inductanceCurrent = Curve {Curve::Shape::saturation, 0.1, 2.0, 0.0, 0.0};
    CHECK(std::abs(imbalance(speaker)) < 1e-7);
}

TEST_CASE("lossy elements only lose energy", "[bench]")
{
    Loudspeaker speaker;
    SECTION("eddy currents") { speaker.eddyCurrents = EddyCurrents {0.05, 0.6}; }
    SECTION("moving eddy currents")
    {
        speaker.inductancePosition = Curve {Curve::Shape::arctanStep, 0.5e-3, 2e-3, 0.6, 0.0};
        speaker.eddyCurrents = EddyCurrents {0.05, 0.6, {}, true};
    }
    SECTION("creep") { speaker.creep = Creep {Creep::Family::logarithmic, 0.1, 3.0, 1000.0, 0.0}; }
    SECTION("friction") { speaker.friction = Friction {{{1000.0, 0.5}}}; }
    // What the balance lacks is what they have taken (their own stored part included).
    CHECK(imbalance(speaker) > 1e-4);
}

TEST_CASE("loops in the iron that move with the inductance add to it when they lose nothing", "[bench]")
{
    Loudspeaker whole, parts;
    whole.Le = 3e-3;
    whole.inductancePosition = Curve {Curve::Shape::arctanStep, 0.5e-3, 2e-3, 0.6, 0.0};
    parts = whole;
    parts.Le = 1e-3;
    constexpr double rate = 1e9;  // beyond anything that is played: the loop's resistance carries nothing
    parts.eddyCurrents = EddyCurrents {0.0, 0.6, {{2e-3 * rate, rate}}, true};

    const double h = 5e-6;
    const auto start = [h](const Loudspeaker& speaker) { return Simulator(speaker, h, 1.5e5, 6.0); };
    auto one = start(whole), other = start(parts);
    parts.eddyCurrents->moves = false;
    auto fixed = start(parts);
    double largest = 0.0, difference = 0.0, fixedDifference = 0.0;
    for (int n = 0; n < 4000; ++n) {
        Triple u {};
        for (int j = 0; j < 3; ++j) {
            const double t = h * (n + Radau::points()[j]);
            u[j] = 14.0 * std::sin(2.0 * std::numbers::pi * 55.0 * t)
                   + 6.0 * std::sin(2.0 * std::numbers::pi * 730.0 * t);
        }
        const double current = one.step(u).current;
        largest = std::max(largest, std::abs(current));
        difference = std::max(difference, std::abs(other.step(u).current - current));
        fixedDifference = std::max(fixedDifference, std::abs(fixed.step(u).current - current));
    }
    CHECK(difference < 1e-4 * largest);
    CHECK(fixedDifference > 1e-2 * largest);
}
