// SPDX-License-Identifier: GPL-3.0-or-later
// The limit of the excursion behind an amplifier that lets no constant voltage pass. What comes out of the predistorter
// goes through the amplifier, then to the driver as Loudspeaker/Simulate integrates it.
#include "Predistortion/Amplified.h"
#include "Predistortion/Drivers.h"
#include "Predistortion/Lopsided.h"
#include "Predistortion/Programme.h"

#include "Engine/Loudspeaker/Resonance.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Predistortion/CouplingFilter.h"
#include "Engine/Predistortion/DriverMotion.h"
#include "Engine/Predistortion/Predistorter.h"
#include "Engine/Predistortion/RealTime.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

using namespace excursion;

namespace {

/// Tones, bursts of them, noise, and drums, for some seconds, so loud that the limit acts.
/// @param which  0 to 7
Programme programme(int which, const Model& model, double limit, double rate, double seconds)
{
    const double f0 = resonanceOf(model);
    Programme made;
    auto& u = made.samples;
    u.resize(static_cast<std::size_t>(seconds * rate));
    const double frequencies[] {0.5 * f0, f0, 1.7 * f0};
    const auto sine = [](double f, double t) { return std::sin(2.0 * std::numbers::pi * f * t); };
    if (which < 6) {
        const double f = frequencies[which % 3], volts = 1.5 * voltsTo(model, limit, f);
        made.name = (which < 3 ? "tone of " : "bursts of ") + std::to_string(f) + " Hz";
        for (std::size_t n = 0; n < u.size(); ++n) {
            const double t = static_cast<double>(n) / rate, since = std::fmod(t, 0.5);
            if (which < 3)
                u[n] = volts * std::min(1.0, t / 0.1) * sine(f, t);
            else if (since < 6.0 / f)
                u[n] = volts * sine(f, since);
        }
        return made;
    }
    Draw draw(static_cast<unsigned>(which));
    const auto noise = pinkNoise(draw, u.size());
    const double volts = 1.5 * voltsTo(model, limit, f0);
    made.name = which == 6 ? "noise" : "drums";
    for (std::size_t n = 0; n < u.size(); ++n) {
        const double t = static_cast<double>(n) / rate, since = std::fmod(t, 0.35);
        u[n] = volts * (which == 6 ? noise[n] : 0.2 * noise[n] + sine(1.1 * f0, since) * std::exp(-12.0 * since));
    }
    return made;
}

constexpr int programmes = 8;

/// How far the driver goes behind the amplifier, in units of the limit.
double reached(const Model& model, const Programme& programme, double limit, double rate,
               const AmplifierCoupling& amplifier)
{
    PredistortionControls controls;
    controls.displacementLimit = limit;
    Predistorter engine(model, {rate, 2, amplifier}, controls);
    const auto out = through(engine, programme.samples);
    const auto meters = engine.collectMeters();
    CHECK(meters.faults == 0);
    const double x = peak(
        simulate(model, amplified(amplifier, out, rate), rate, {}).find(Quantity::displacement)->samples);
    CHECK(meters.displacement == Approx(x).epsilon(0.01));
    return x / limit;
}

/// How far it goes, in units of the limit, from a fifth of a second after the correction has been switched on: a cone
/// that was beyond the limit needs that to come back.
double reachedAfter(std::size_t switched, std::vector<double> u, const Model& model, double limit, double rate,
                    const AmplifierCoupling& amplifier)
{
    PredistortionControls controls;
    controls.displacementLimit = limit;
    Predistorter engine(model, {rate, 2, amplifier}, controls);
    engine.turn(false);
    engine.process(u.data(), u.data(), switched);
    engine.turn(true);
    engine.process(u.data() + switched, u.data() + switched, u.size() - switched);
    const auto take = simulate(model, amplified(amplifier, u, rate), rate, {});
    const auto& x = take.find(Quantity::displacement)->samples;
    const auto from = x.begin() + static_cast<std::ptrdiff_t>(switched + static_cast<std::size_t>(0.2 * rate));
    return peak({from, x.end()}) / limit;
}

}  // namespace

TEST_CASE("What an amplifier withholds is withheld by its filter", "[protection]")
{
    const double rate = 8000.0;
    for (const auto& coupling : {capacitor, filter, AmplifierCoupling {20.0, 2}}) {
        CouplingFilter withheld(coupling, rate);
        const auto u = burst(rate, 1.0, 3.0);
        std::vector<double> passed;
        for (const double sample : u) {
            const double kept = withheld.coming() + withheld.direct() * sample;
            withheld.take(sample);
            passed.push_back(sample - kept);
        }
        CHECK(relativeError(passed, amplified(coupling, u, rate)) < 1e-3);
    }
    CouplingFilter none({}, rate);
    none.take(3.0);
    CHECK(none.coming() == 0.0);
    CHECK(none.direct() == 0.0);
}

TEST_CASE("The excursion's limit holds behind an amplifier that passes no constant voltage", "[protection][slow]")
{
    double worst = 0.0;
    for (const double rate : {48000.0, 8000.0})
        for (const double share : {0.2, 0.3})
            for (const bool motorToo : {true, false}) {
                const auto model = lopsided(share, motorToo);
                const double limit = 0.9 * measuredDisplacement(model);
                for (const auto& amplifier : {capacitor, filter})
                    for (int which = 0; which < programmes; ++which) {
                        const auto played = programme(which, model, limit, rate, 1.5);
                        const double most = reached(model, played, limit, rate, amplifier);
                        INFO("asymmetry " << share << (motorToo ? " of both" : ", the motor's against it") << ", "
                                          << played.name << " at " << rate << " Hz, order " << amplifier.order);
                        CHECK(most < 1.01);
                        CHECK(most > 0.65);  // not by doing nothing
                        worst = std::max(worst, most);
                    }
            }
    WARN("at most " << 100.0 * worst << " % of the excursion's limit");
}

TEST_CASE("An amplifier that charges drives the cone on when the sound stops, which is foreseen", "[protection]")
{
    // Slow signals, far too loud: what is withheld is as large as what is played, and a cone of high losses goes on for
    // long after it was let go.
    auto overdamped = lopsided(0.2, true);
    overdamped.baseParameter("Rms").value = 6.0;
    for (const auto& model : {lopsided(0.2, true), overdamped})
        for (const auto& amplifier : {capacitor, filter, AmplifierCoupling {1.5, 2}})
            for (const double frequency : {0.7, 5.0}) {
                const double limit = 0.5 * measuredDisplacement(model), rate = 8000.0;
                Programme square {"square", std::vector<double>(static_cast<std::size_t>(4.0 * rate))};
                for (std::size_t n = 0; n < square.samples.size(); ++n)
                    square.samples[n] = 3.0 * voltsTo(model, limit, 1.0)
                                        * (std::fmod(frequency * static_cast<double>(n) / rate, 1.0) < 0.5 ? -1.0
                                                                                                           : 1.0);
                INFO(frequency << " Hz, order " << amplifier.order << ", corner " << amplifier.corner << " Hz");
                CHECK(reached(model, square, limit, rate, amplifier) < 1.01);
            }
}

TEST_CASE("The limit holds as soon as the correction is switched on, however the amplifier was charged", "[protection]")
{
    const auto model = lopsided(0.2, true);
    const double limit = 0.6 * measuredDisplacement(model), rate = 8000.0;
    for (const auto& amplifier : {capacitor, filter, AmplifierCoupling {0.5, 1}}) {
        // What is played before charges the amplifier one way, what follows comes on top of that.
        std::vector<double> u(static_cast<std::size_t>(3.0 * rate));
        const std::size_t switched = u.size() / 2;
        for (std::size_t n = 0; n < u.size(); ++n)
            u[n] = (n < switched ? -2.0 : 2.0) * voltsTo(model, limit, 1.0);
        INFO("order " << amplifier.order << ", corner " << amplifier.corner << " Hz");
        CHECK(reachedAfter(switched, u, model, limit, rate, amplifier) < 1.01);
    }
}

TEST_CASE("A sound within the limit is watched until a slow amplifier has forgotten what charged it", "[protection]")
{
    const auto model = lopsided(0.2, true);
    const double limit = 0.6 * measuredDisplacement(model), rate = 48000.0, tone = 20.0;
    std::vector<double> u(static_cast<std::size_t>(12.0 * rate));
    const std::size_t switched = 3 * u.size() / 4;
    for (std::size_t n = 0; n < u.size(); ++n)
        u[n] = n < switched ? -1.0 * voltsTo(model, limit, 1.0)
                            : 0.65 * voltsTo(model, limit, tone)
                                  * std::sin(2.0 * std::numbers::pi * tone * static_cast<double>(n) / rate);
    CHECK(reachedAfter(switched, u, model, limit, rate, {AmplifierCoupling::lowest, 1}) < 1.01);
}

TEST_CASE("What plays past the correction charges the amplifier, too", "[protection]")
{
    const auto model = lopsided(0.2, true);
    const double rate = 8000.0, limit = 0.6 * measuredDisplacement(model);
    const AmplifierCoupling amplifier {0.5, 1};
    PredistortionControls controls;
    controls.displacementLimit = limit;
    Predistorter engine(model, {rate, 2, amplifier}, controls);
    std::vector<double> u(static_cast<std::size_t>(3.0 * rate));
    const std::size_t switched = u.size() / 2;
    for (std::size_t n = 0; n < u.size(); ++n)
        u[n] = (n < switched ? -2.0 : 2.0) * voltsTo(model, limit, 1.0);
    engine.turn(false);
    engine.pass(u.data(), switched);
    engine.turn(true);
    engine.process(u.data() + switched, u.data() + switched, u.size() - switched);
    const auto take = simulate(model, amplified(amplifier, u, rate), rate, {});
    const auto& x = take.find(Quantity::displacement)->samples;
    const auto from = x.begin() + static_cast<std::ptrdiff_t>(switched + static_cast<std::size_t>(0.2 * rate));
    CHECK(peak({from, x.end()}) < 1.01 * limit);
}

TEST_CASE("An amplifier stays charged through a fault, and when another engine takes over", "[protection]")
{
    const auto model = lopsided(0.2, true);
    const double rate = 8000.0;
    for (const auto& amplifier : {AmplifierCoupling {0.5, 1}, AmplifierCoupling {0.5, 2}}) {
        Predistorter engine(model, {rate, 2, amplifier});
        // Twice something that is so loud that the correction asks for more than can be, and silence at the end.
        std::vector<double> u(static_cast<std::size_t>(2.0 * rate), 1.0);
        for (const std::size_t from : {u.size() / 4, u.size() / 2})
            std::fill_n(u.begin() + static_cast<std::ptrdiff_t>(from), 80, 0.99 * Plausible(model).input());
        std::fill(u.end() - 800, u.end(), 0.0);
        const auto out = through(engine, u);
        REQUIRE(engine.collectMeters().faults > 0);
        CouplingFilter expected(amplifier, rate);
        for (const double sample : out)
            expected.take(sample);
        const auto charge = engine.warmth().charge;
        REQUIRE(std::abs(expected.charge()[0]) > 0.1);
        for (std::size_t k = 0; k < charge.size(); ++k)
            CHECK(charge[k] == Approx(expected.charge()[k]).margin(0.02 * std::abs(expected.charge()[0])));
        Predistorter next(model, {rate, 2, amplifier});
        next.warm({.charge = charge});
        CHECK(next.warmth().charge == charge);
    }
}

TEST_CASE("An amplifier of another order keeps back what the one before did", "[protection]")
{
    const double rate = 8000.0;
    for (const int order : {1, 2}) {
        CouplingFilter before({2.0, order}, rate), after({2.0, 3 - order}, rate);
        for (int n = 0; n < 4 * static_cast<int>(rate); ++n)
            before.take(1.0);
        CHECK(before.charge()[0] == Approx(1.0).epsilon(1e-3));
        after.charge(before.charge());
        for (int n = 0; n < static_cast<int>(rate); ++n) {
            REQUIRE(after.coming() + after.direct() == Approx(1.0).margin(0.01));
            after.take(1.0);
        }
    }
}

TEST_CASE("A driver without a coil is protected behind an amplifier, too", "[protection]")
{
    auto model = withEffect(makeModel("mechanical"), effectNamed("stiffness"),
                            lopsided(0.2, true).components[1].operatingRange);
    const auto motion = linearMotion(model, 8000.0, capacitor);
    CHECK(motion.leastCorrection.size() == motion.mostCorrection.size());
    CHECK(motion.leastCorrection.size() > 1);
}

TEST_CASE("Behind an amplifier that is stated less distortion is left than behind one that is not", "[protection]")
{
    constexpr double rate = 48000.0, frequency = 60.0;
    const auto model = lopsided(0.2, true);
    const double volts = 0.5 * voltsTo(model, measuredDisplacement(model), frequency);
    std::vector<double> u(static_cast<std::size_t>(3.0 * rate));
    for (std::size_t n = 0; n < u.size(); ++n) {
        const double t = static_cast<double>(n) / rate;
        u[n] = volts * std::min(1.0, t) * std::sin(2.0 * std::numbers::pi * frequency * t);
    }
    // Power of the harmonics over that of the tone, in the last second but its end, dB.
    const auto distortion = [&](const AmplifierCoupling& stated, const AmplifierCoupling& amplifier) {
        Predistorter engine(model, {rate, 2, stated});
        const auto take = simulate(model, amplified(amplifier, through(engine, u), rate), rate, {});
        const auto& x = take.find(Quantity::displacement)->samples;
        double tone = 0.0, rest = 0.0;
        for (int harmonic = 1; harmonic <= 8; ++harmonic) {
            std::complex<double> sum = 0.0;
            for (std::size_t n = 0; n < static_cast<std::size_t>(rate); ++n)
                sum += x[x.size() - 1000 - n]
                       * std::polar(1.0, 2.0 * std::numbers::pi * harmonic * frequency * static_cast<double>(n) / rate);
            (harmonic == 1 ? tone : rest) += std::norm(sum);
        }
        return 10.0 * std::log10(rest / tone);
    };
    for (const auto& amplifier : {capacitor, filter}) {
        const double unaware = distortion({}, amplifier), aware = distortion(amplifier, amplifier);
        INFO("order " << amplifier.order << ": " << unaware << " dB, stated " << aware << " dB");
        CHECK(aware < -55.0);
        CHECK(aware < unaware - 12.0);
    }
}

TEST_CASE("Of an amplifier's high-pass only those are taken that are one", "[protection]")
{
    for (const auto& [corner, order] : {std::pair {-1.0, 1}, {0.05, 1}, {25.0, 1}, {2.0, 0}, {2.0, 3}}) {
        std::string reason;
        CHECK_FALSE(RealTimeOptions {48000.0, 2, {corner, order}}.isValid(&reason));
        CHECK_THAT(reason, Catch::Contains("amplifier"));
    }
    CHECK(RealTimeOptions {48000.0, 2, {0.0, 1}}.isValid(nullptr));
    CHECK(RealTimeOptions {48000.0, 2, {20.0, 2}}.isValid(nullptr));
}
