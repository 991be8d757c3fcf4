// SPDX-License-Identifier: GPL-3.0-or-later
// What a target of predistortion costs is told beforehand as it is then found.
#include "Predistortion/Targets.h"

#include "Bench/Bench.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Predistortion/Chain.h"
#include "Engine/Predistortion/Predistorter.h"
#include "Engine/Predistortion/TargetForecast.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Multisine.h"
#include "Engine/Take/Air.h"

#include <catch2/catch.hpp>

#include <complex>

using namespace excursion;
using namespace excursion::test;

TEST_CASE("What a target costs is told as it is then found", "[predistortion][target]")
{
    constexpr double rate = 48000.0;
    const auto model = withStrong(midbass(), effectNamed("stiffness"));
    auto controls = towards(30.0, 0.707);
    controls.displacementLimit = xmax;
    controls.voltageLimit = 12.0;
    const auto told = forecastTarget(model, controls, 10.0);
    const auto own = ownOf({});
    CHECK(told.own.frequency == Approx(own.frequency).epsilon(1e-6));
    CHECK(told.played.frequency == 30.0);
    CHECK(told.lowGainDb == Approx(40.0 * std::log10(own.frequency / 30.0)).epsilon(1e-6));
    CHECK(told.targetPink.displacement > told.ownPink.displacement);
    CHECK(told.targetPink.roomDb < told.ownPink.roomDb);
    const bench::Loudspeaker driver;
    for (std::size_t k = 0; k < told.frequency.size(); k += 10) {
        const double f = told.frequency[k];
        if (f > 400.0)
            break;
        CHECK(told.targetMoves[k] == Approx(10.0 * std::abs(targetResponse(driver, told.played, f))).epsilon(1e-3));
        CHECK(told.ownMoves[k] == Approx(10.0 * std::abs(targetResponse(driver, own, f))).epsilon(1e-3));
        CHECK(told.targetDb[k] - told.ownDb[k]
              == Approx(20.0 * std::log10(told.targetMoves[k] / told.ownMoves[k])).margin(1e-9));
    }
    // At the level that is told sines of any frequency keep the limits, and a little louder not all of them do.
    const auto reached = [&](double extraDb) {
        const double volts = 10.0 * std::pow(10.0, 0.05 * (told.targetSine.roomDb + extraDb));
        double worst = 0.0;
        for (const double f : {8.0, 14.0, 20.0, 28.0, 40.0, 56.0, 80.0, 160.0}) {
            std::vector<double> u(static_cast<std::size_t>(1.5 * rate));
            for (std::size_t n = 0; n < u.size(); ++n)
                u[n] = volts * std::min(1.0, 2.0 * static_cast<double>(n) / rate)
                       * std::sin(2.0 * std::numbers::pi * f * static_cast<double>(n) / rate);
            Predistorter unlimited(model, {rate, 2}, towards(30.0, 0.707));
            const auto bent = through(unlimited, u);
            const auto x = exact(model, bent, rate).find(Quantity::displacement)->samples;
            const auto end = static_cast<std::ptrdiff_t>(rate);
            worst = std::max({worst, peak({x.begin() + end, x.end()}) / controls.displacementLimit,
                              peak({bent.begin() + end, bent.end()}) / controls.voltageLimit});
        }
        return worst;
    };
    CHECK(reached(0.0) < 1.01);
    CHECK(reached(1.0) > 1.03);
    // Without limits there is no end of room.
    CHECK(std::isinf(forecastTarget(model, towards(30.0, 0.707), 10.0).targetPink.roomDb));
    CHECK_THROWS_AS(forecastTarget(model, towards(2.0, 0.7), 10.0), Error);
    CHECK_THROWS_AS(forecastTarget(model, towards(30.0, 0.7), 0.0), Error);
}

TEST_CASE("The room that is told is there when it is played, margin and all", "[predistortion][target]")
{
    constexpr double rate = 48000.0;
    const auto model = withStrong(midbass(), effectNamed("stiffness"));
    auto controls = towards(35.0, 0.9);
    controls.displacementLimit = xmax;
    controls.margin = 0.15;
    constexpr double volts = 10.0;
    const auto told = forecastTarget(model, controls, volts);
    const auto reductionAt = [&](const std::vector<double>& u, double db) {
        Predistorter predistorter(model, {rate, 2}, controls);
        auto loud = u;
        for (auto& sample : loud)
            sample *= volts * std::pow(10.0, 0.05 * db);
        through(predistorter, loud);
        return predistorter.collectMeters().displacementReduction;
    };
    double within = 0.0, beyond = 0.0;
    for (const double f : {9.0, 14.0, 20.0, 28.0, 35.0, 50.0, 75.0, 120.0}) {
        std::vector<double> u(static_cast<std::size_t>(1.5 * rate));
        for (std::size_t n = 0; n < u.size(); ++n)
            u[n] = std::min(1.0, 2.0 * static_cast<double>(n) / rate)
                   * std::sin(2.0 * std::numbers::pi * f * static_cast<double>(n) / rate);
        within = std::max(within, reductionAt(u, told.targetSine.roomDb - 0.5));
        beyond = std::max(beyond, reductionAt(u, told.targetSine.roomDb + 1.0));
    }
    CHECK(within < 0.1);
    CHECK(beyond > 0.3);
}
