// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Fixture.h"

#include <catch2/catch.hpp>

#include <numbers>

using namespace excursion;
using namespace excursion::bench;

namespace {

// Largest relative error of current, displacement and pressure per volt against the closed form, in dB.
// Displacement is read up to 500 Hz: a memory that still settles drifts, and above, where the cone hardly moves, the
// line's share of that drift is all there is to see.
double againstClosedForm(const Loudspeaker& speaker, const BenchSetup& setup)
{
    const auto take = measure(speaker, setup);
    const auto U = lastPeriod(take, Quantity::voltage), I = lastPeriod(take, Quantity::current),
               X = lastPeriod(take, Quantity::displacement), P = lastPeriod(take, Quantity::pressure);
    double worst = 0.0;
    for (const int line : take.excitation->lines) {
        const auto k = static_cast<std::size_t>(line);
        const double f = line * setup.sampleRate / setup.excitation.period;
        const auto truth = speaker.small(f);
        const auto flight = std::polar(1.2 * speaker.coneArea / (2.0 * std::numbers::pi * setup.microphoneDistance),
                                       -2.0 * std::numbers::pi * f * setup.microphoneDistance / 343.0);
        worst = std::max(worst, std::abs(I[k] / U[k] / truth.current - 1.0));
        if (f < 500.0)
            worst = std::max(worst, std::abs(X[k] / U[k] / truth.displacement - 1.0));
        worst = std::max(worst, std::abs(P[k] / U[k] / (flight * truth.radiated) - 1.0));
    }
    return dB(worst);
}

}  // namespace

TEST_CASE("a linear driver's steady state is the closed form", "[bench]")
{
    auto setup = quietSetup();
    setup.excitation.settlePeriods = 3;
    for (const double rate : {44100.0, 48000.0, 96000.0}) {
        setup.sampleRate = rate;
        CHECK(againstClosedForm(Loudspeaker {}, setup) < -120.0);
    }
}

TEST_CASE("linear effects are their closed forms", "[bench][slow]")
{
    auto setup = quietSetup();
    setup.excitation.settlePeriods = 20;  // creep and eddy currents have long memories
    Loudspeaker speaker;

    SECTION("eddy currents")
    {
        for (const double exponent : {0.45, 0.65, 0.9}) {
            speaker.eddyCurrents = EddyCurrents {2.0 / std::pow(6000.0, exponent), exponent};
            CHECK(againstClosedForm(speaker, setup) < -100.0);
        }
    }
    SECTION("eddy currents in a chain of cells")
    {
        speaker.eddyCurrents = EddyCurrents {0.0, 0.6, {{0.3, 900.0}, {1.1, 5000.0}, {2.5, 40000.0}}};
        CHECK(againstClosedForm(speaker, setup) < -100.0);
    }
    SECTION("creep in a chain of cells")
    {
        speaker.creep = Creep {Creep::Family::chain, 0.0, 0.0, 0.0, 0.0, {{0.1, 12.0}, {0.2, 90.0}, {0.05, 1500.0}}};
        CHECK(againstClosedForm(speaker, setup) < -100.0);
    }
    SECTION("logarithmic creep")
    {
        speaker.creep = Creep {Creep::Family::logarithmic, 0.08, 6.0, 2000.0, 0.0};
        CHECK(againstClosedForm(speaker, setup) < -100.0);
    }
    SECTION("standard creep")
    {
        speaker.creep = Creep {Creep::Family::standard, 0.4, 30.0, 0.0, 0.0};
        CHECK(againstClosedForm(speaker, setup) < -100.0);
    }
    SECTION("fractional creep")
    {
        speaker.creep = Creep {Creep::Family::fractional, 0.3, 300.0, 0.0, 0.2};
        CHECK(againstClosedForm(speaker, setup) < -100.0);
    }
    SECTION("vented box")
    {
        speaker.ventedBox = VentedBox {2500.0, 0.02, 0.7};
        CHECK(againstClosedForm(speaker, setup) < -100.0);
    }
    SECTION("passive radiator in a box that leaks and absorbs")
    {
        speaker.ventedBox = VentedBox {2500.0, 0.02, 0.7, 60.0, 0.3, 700.0};
        CHECK(againstClosedForm(speaker, setup) < -100.0);
    }
    SECTION("parts that hang on the cone")
    {
        speaker.sideResonance = {{0.002, 310.0, 8.0}, {0.0007, 1200.0, 4.0}};
        CHECK(againstClosedForm(speaker, setup) < -100.0);
    }
}

TEST_CASE("a cone mode leaves its resonance in the pressure alone", "[bench]")
{
    auto setup = quietSetup();
    setup.excitation.settlePeriods = 3;
    Loudspeaker speaker;
    const auto without = measure(speaker, setup);
    speaker.coneBreakup = {{3000.0, 10.0, 0.05}};
    const auto with = measure(speaker, setup);
    CHECK(difference(with, without, Quantity::current).band < -200.0);
    const auto P = lastPeriod(with, Quantity::pressure), P0 = lastPeriod(without, Quantity::pressure);
    double worst = 0.0;
    for (const int line : with.excitation->lines) {
        const auto k = static_cast<std::size_t>(line);
        const std::complex<double> s {0.0, line * setup.sampleRate / setup.excitation.period / 3000.0};
        const auto truth = 1.0 - 0.05 * s * s / (s * s + s / 10.0 + 1.0);
        worst = std::max(worst, std::abs(P[k] / P0[k] / truth - 1.0));
    }
    CHECK(dB(worst) < -100.0);
}

TEST_CASE("a driver plays any record", "[bench]")
{
    auto setup = quietSetup();
    const auto take = measure(Loudspeaker {}, setup);
    // What was recorded is what was played, so playing the record again gives the same current.
    const auto again = play(Loudspeaker {}, take.find(Quantity::voltage)->samples, setup.sampleRate,
                            {Quantity::voltage, Quantity::current});
    CHECK(!again.excitation);
    double error = 0.0, power = 0.0;
    const auto &a = take.find(Quantity::current)->samples, &b = again.find(Quantity::current)->samples;
    for (std::size_t n = 0; n + 500 < a.size(); ++n) {  // the record breaks off at its end
        error += (a[n] - b[n]) * (a[n] - b[n]);
        power += a[n] * a[n];
    }
    CHECK(dB(std::sqrt(error / power)) < -90.0);
}
