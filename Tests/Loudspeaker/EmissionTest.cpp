// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Arrival.h"
#include "Engine/Loudspeaker/Radiator.h"
#include "Engine/Loudspeaker/Sensors.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Loudspeaker/EffectBench.h"

#include <catch2/catch.hpp>

#include <complex>

using namespace excursion;

namespace {

constexpr double turn = 2.0 * std::numbers::pi;

/// When what arrives at t has left a source that is late by depth sin(w s): the root of s + depth sin(w s) = t.
double leaving(double t, double depth, double w)
{
    double s = t;
    for (int k = 0; k < 50; ++k)
        s -= (s + depth * std::sin(w * s) - t) / (1.0 + depth * w * std::cos(w * s));
    return s;
}

}  // namespace

TEST_CASE("A tone from a moving source arrives phase-modulated, as the root of its time of flight says", "[emission]")
{
    constexpr double rate = 48000.0, low = 50.0, high = 9000.0, depth = 6e-3 / 343.0;
    constexpr std::size_t N = 4800;
    std::vector<double> lateness(N), tone(N);
    for (std::size_t n = 0; n < N; ++n) {
        const double t = static_cast<double>(n) / rate;
        lateness[n] = depth * std::sin(turn * low * t);
        tone[n] = std::cos(turn * high * t);
    }
    const Arrival arrival(lateness, rate);
    const auto heard = arrival.heard(tone);
    double worst = 0.0;
    for (std::size_t n = 0; n < N; ++n)
        worst = std::max(
            worst,
            std::abs(heard[n] - std::cos(turn * high * leaving(static_cast<double>(n) / rate, depth, turn * low))));
    CHECK(worst < 2e-6);
    CHECK(Arrival(std::vector<double>(N, 0.0), rate).heard(tone) == tone);
}

TEST_CASE("The phase of a tone heard under a moving cone swings by w x / c", "[emission]")
{
    auto model = withEffect(makeModel("electrodynamic"), effectNamed("doppler"), someOperatingRange(1.0));
    model.components.back().parameters.front().value = 1.0 / 343.0;
    constexpr double rate = 48000.0, low = 50.0, high = 6000.0, x = 4e-3;
    constexpr std::size_t N = 4800;
    const std::vector<double> zero(N, 0.0);
    Trajectory run {zero, {}, zero, {}, {}, {}, zero};
    Radiator radiator(model);
    for (std::size_t n = 0; n < N; ++n) {
        const double t = static_cast<double>(n) / rate;
        run.displacement.push_back(x * std::sin(turn * low * t));
        run.acceleration.push_back(std::cos(turn * high * t));
        const double z[] {0.0, run.displacement.back(), 0.0};
        const auto sound = radiator.at(z, run.acceleration.back());
        run.flow.push_back(sound.flow);
        run.lateness.push_back(sound.lateness);
    }
    const auto P = Sensors(model, run, rate).seen(Quantity::pressure);
    const auto line = [&](double f) { return std::abs(P[static_cast<std::size_t>(std::lround(f * N / rate))]); };
    // Sidebands of a phase modulated by beta sin: J_n(beta), each side alike but for the Mach number.
    const double beta = turn * high * x / 343.0;
    CHECK(std::abs(line(high) / std::abs(std::cyl_bessel_j(0, beta)) / (line(high + low) / std::cyl_bessel_j(1, beta))
                   - 1.0)
          < 0.02);
    CHECK(std::abs(line(high - low) / line(high + low) - 1.0) < 0.05);
    CHECK(std::abs(line(high + 2.0 * low) / line(high + low) / (std::cyl_bessel_j(2, beta) / std::cyl_bessel_j(1, beta))
                   - 1.0)
          < 0.02);
}

TEST_CASE("Modes of the cone are heard and seen, and not felt by the coil", "[emission]")
{
    auto model = withEffect(makeModel("electrodynamic"), effectNamed("cone-breakup"), someOperatingRange(1.0));
    const auto plain = withoutEffect(model, "cone-breakup");
    auto& p = model.components.back().parameters;
    p[2].value = 0.3;   // g1
    p[3].value = -0.2;  // h1
    const double w0 = turn * 8000.0 * std::exp2(0.75 * -3.5);
    std::vector<double> frequency;
    for (double f = 20.0; f < 12000.0; f *= 1.13)
        frequency.push_back(f);
    const std::vector<Quantity> all {Quantity::current, Quantity::displacement, Quantity::velocity,
                                     Quantity::acceleration, Quantity::pressure};
    const auto with = respond(model, all, frequency), without = respond(plain, all, frequency);
    for (std::size_t f = 0; f < frequency.size(); ++f) {
        const std::complex<double> s(0.0, turn * frequency[f]);
        const auto r = -s * s / (s * s + s * w0 / 5.0 + w0 * w0);  // per displacement of the coil
        const auto near = [&](std::size_t q, std::complex<double> factor) {
            return std::abs(with[q].value[f] / without[q].value[f] - factor) < 1e-8;
        };
        CAPTURE(frequency[f]);
        CHECK(near(0, 1.0));
        for (const std::size_t motion : {1, 2, 3})
            CHECK(near(motion, 1.0 - 0.2 * r));
        CHECK(near(4, 1.0 + 0.3 * r));
    }
}
