// SPDX-License-Identifier: GPL-3.0-or-later
// What is heard, and foretold, of a loudspeaker behind an amplifier that lets no constant voltage pass.
#include "Predistortion/Amplified.h"
#include "Predistortion/Drivers.h"
#include "Predistortion/Lopsided.h"

#include "Engine/Loudspeaker/Resonance.h"
#include "Engine/Predistortion/Chain.h"
#include "Engine/Predistortion/PredictedDistortion.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

using namespace excursion;

TEST_CASE("The speaker of a chain stands behind an amplifier as charged as the correction reckons with", "[chain]")
{
    const auto model = lopsided(0.2, true);
    const double rate = 8000.0;
    const AmplifierCoupling amplifier {0.5, 1};
    std::vector<double> u(static_cast<std::size_t>(4.0 * rate));
    for (std::size_t n = 0; n < u.size(); ++n)
        u[n] = 0.5 + 0.2 * std::sin(2.0 * std::numbers::pi * 60.0 * static_cast<double>(n) / rate);
    const auto play = [&](Chain& chain, std::size_t from, std::size_t to) {
        std::vector<double> out(u.begin() + static_cast<std::ptrdiff_t>(from),
                                u.begin() + static_cast<std::ptrdiff_t>(to));
        chain.process(out.data(), out.data(), out.size());
        return out;
    };
    const ChainControls linearize {Mode::linearize, 4.0, 1.0, {}}, audition {Mode::audition, 4.0, 1.0, {}};
    const std::size_t switched = u.size() / 2, settled = switched + static_cast<std::size_t>(0.3 * rate);
    Chain always(model, {rate, 2, amplifier}, audition), joined(model, {rate, 2, amplifier}, linearize);
    play(always, 0, switched);
    play(joined, 0, switched);
    joined.set(audition);
    Chain next(model, {rate, 2, amplifier}, audition);
    next.takeOver(always);
    for (auto* chain : {&always, &joined, &next})
        play(*chain, switched, settled);
    always.collectMeters();
    joined.collectMeters();
    next.collectMeters();
    for (auto* chain : {&always, &joined, &next})
        play(*chain, settled, settled + static_cast<std::size_t>(0.2 * rate));
    const double expected = always.collectMeters().speaker.displacement;
    CHECK(joined.collectMeters().speaker.displacement == Approx(expected).epsilon(0.02));
    // Its amplifier loses some of the charge until the sound has come through its delays.
    CHECK(next.collectMeters().speaker.displacement == Approx(expected).epsilon(0.1));
}

TEST_CASE("A speaker that is heard through a chain stands behind the same amplifier", "[chain]")
{
    const auto model = lopsided(0.2, true);
    const double rate = 48000.0;
    const auto u = burst(rate, 0.5, 1.0);
    const auto heard = [&](const AmplifierCoupling& amplifier, Mode mode, const std::vector<double>& signal) {
        Chain chain(model, {rate, 2, amplifier}, {mode, 4.0, 1.0, {}});
        return through(chain, signal);
    };
    for (const auto& amplifier : {AmplifierCoupling {20.0, 1}, AmplifierCoupling {20.0, 2}}) {
        const auto expected = heard({}, Mode::speaker, amplified(amplifier, u, rate));
        CHECK(relativeError(heard(amplifier, Mode::speaker, u), expected) < 1e-3);
        CHECK(relativeError(heard({}, Mode::speaker, u), expected) > 0.05);
    }
    for (const auto& amplifier : {capacitor, filter}) {
        Chain linear(linearPart(model), {rate, 2, amplifier}, {Mode::speaker, 4.0, 1.0, {}});
        const auto wanted = through(linear, u);
        CHECK(relativeError(heard(amplifier, Mode::audition, u), wanted)
              < 0.2 * relativeError(heard(amplifier, Mode::speaker, u), wanted));
    }
}

TEST_CASE("The distortion that is predicted is that behind the amplifier", "[protection]")
{
    const auto model = lopsided(0.2, true);
    const double volts = 0.5 * voltsTo(model, measuredDisplacement(model), resonanceOf(model));
    const auto free = predictDistortion(model, {}, volts),
               behind = predictDistortion(model, {}, volts, {48000.0, 2, capacitor});
    CHECK(behind.beforeDb == Approx(free.beforeDb).margin(2.0));
    CHECK(behind.afterDb < behind.beforeDb - 12.0);
}
