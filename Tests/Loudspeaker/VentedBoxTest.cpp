// SPDX-License-Identifier: GPL-3.0-or-later
// The air spring that cone and port share, against closed forms and the independent bench.
#include "Bench/Loudspeaker.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FitResponse.h"
#include "Engine/Loudspeaker/MatchSound.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Loudspeaker/BenchTwin.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace excursion;

namespace {

constexpr double turn = 2.0 * std::numbers::pi;

/// The base's midbass in a box of these parameters: Kb, fB, 1/QP, 1/QL, 1/QA, Kp/Ka; the port is heard in full.
Model boxed(std::vector<double> parameters, const char* base = "electrodynamic")
{
    OperatingRange operatingRange;
    operatingRange.lowFrequency = 5.0;
    auto model = withEffect(makeModel(base), effectNamed("vented-box"), operatingRange);
    parameters.push_back(1.0);
    for (std::size_t k = 0; k < parameters.size(); ++k)
        model.components.back().parameters[k].value = parameters[k];
    return model;
}

std::vector<double> frequencies()
{
    std::vector<double> f;
    for (double at = 8.0; at < 1500.0; at *= 1.05)
        f.push_back(at);
    return f;
}

}  // namespace

TEST_CASE("A lossless vented box splits the resonance as Small says", "[effects]")
{
    // f_L^2 + f_H^2 = f_SC^2 + f_B^2 and f_L f_H = f_S f_B, f_S of the cone without, f_SC with the box but without the
    // port.
    auto model = boxed({3000.0, 42.0, 0.0, 0.0, 0.0, 0.0}, "mechanical");
    model.baseParameter("Rms").value = 0.0;
    std::vector<double> f;
    for (const auto& pole : poles(smallSignal(model)))
        if (pole.imag() > 1.0)
            f.push_back(pole.imag() / turn);
    REQUIRE(f.size() == 2);
    const double m = model.baseParameter("m").value, K = model.baseParameter("K").value;
    const double fS = std::sqrt(K / m) / turn, fSC2 = (K + 3000.0) / m / (turn * turn);
    CHECK(f[0] * f[0] + f[1] * f[1] == Approx(fSC2 + 42.0 * 42.0).epsilon(1e-9));
    CHECK(f[0] * f[1] == Approx(fS * 42.0).epsilon(1e-9));
}

TEST_CASE("At the tuning the cone stands still and the port sounds; below, they cancel to the fourth order",
          "[effects]")
{
    const auto model = boxed({3000.0, 42.0, 0.0, 0.0, 0.0, 0.0});
    const auto alone = withoutEffect(model, "vented-box");
    const auto at = [](const Model& m, Quantity quantity, double f) {
        return std::abs(respond(m, {quantity}, {f}).front().value.front());
    };
    CHECK(at(model, Quantity::displacement, 42.0) < 1e-9 * at(alone, Quantity::displacement, 42.0));
    // The air's force is all that the motor has to give: Kb |y| = Bl |i|.
    const double port = 3000.0 * at(model, Quantity::pressure, 42.0)
                        / (radiationPerArea() / model.microphoneDistance * model.path.parameters[0].value
                           * std::pow(turn * 42.0, 2));
    CHECK(port == Approx(model.baseParameter("Bl").value * at(model, Quantity::current, 42.0)).epsilon(1e-6));
    CHECK(at(model, Quantity::pressure, 2.0) / at(model, Quantity::pressure, 1.0) == Approx(16.0).epsilon(0.02));
    CHECK(at(alone, Quantity::pressure, 2.0) / at(alone, Quantity::pressure, 1.0) == Approx(4.0).epsilon(0.02));
}

TEST_CASE("A radiator's spring is heard, and the cone does not feel it", "[effects]")
{
    const auto port = boxed({3000.0, 42.0, 0.1, 0.0, 0.0, 0.0}), radiator = boxed({3000.0, 42.0, 0.0, 0.0, 0.0, 0.25});
    auto damped = radiator;
    damped.components.back().parameters[2].value = 0.1;
    const auto a = respond(port, {Quantity::current}, frequencies()).front().value;
    const auto b = respond(damped, {Quantity::current}, frequencies()).front().value;
    double worst = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k)
        worst = std::max(worst, std::abs(b[k] / a[k] - 1.0));
    CHECK(worst < 1e-3);  // its spring yields a little at the lowest frequencies
    const double notch = 42.0 * std::sqrt(0.25 / 1.25);
    const auto heard = respond(radiator, {Quantity::pressure}, {0.8 * notch, notch, 1.25 * notch}).front().value;
    CHECK(std::abs(heard[1]) < 0.02 * std::min(std::abs(heard[0]), std::abs(heard[2])));
}

TEST_CASE("A box with losses and a radiator is that of the independent bench", "[effects]")
{
    const double Kb = 2400.0, fB = 38.0, dP = 0.08, dL = 0.12, dA = 0.03, r = 0.3, wB = turn * fB;
    const auto model = boxed({Kb, fB, dP, dL, dA, r});
    bench::Loudspeaker speaker;
    takeBase(speaker, model);
    const double Ka = Kb * (1.0 + r), mass = Ka * (1.0 + r) / (wB * wB);
    speaker.K -= Kb * r;  // the engine's K is the stiffness at rest with the box in it
    speaker.ventedBox = bench::VentedBox {Ka, mass, mass * wB * dP, Ka / (wB * dL), Ka * dA / wB, Ka * r};
    const auto f = frequencies();
    const auto response = respond(model, {Quantity::current, Quantity::displacement, Quantity::pressure}, f);
    const double pressure = radiationPerArea() / model.microphoneDistance * model.path.parameters[0].value;
    for (std::size_t k = 0; k < f.size(); ++k) {
        INFO(f[k] << " Hz");
        const auto truth = speaker.small(f[k]);
        const auto arrival = std::exp(std::complex<double>(0.0, -turn * f[k] * model.path.parameters[1].value));
        CHECK(std::abs(response[0].value[k] / truth.current - 1.0) < 2e-3);
        CHECK(std::abs(response[1].value[k] / truth.displacement - 1.0) < 3e-3);
        // Near the notch, where the radiator's spring yields a little, a difference of large numbers is left.
        CHECK(std::abs(response[2].value[k] / arrival / pressure - truth.radiated)
              < 5e-3 * std::abs(truth.radiated) + 5e-3 * std::abs(std::pow(turn * f[k], 2) * truth.displacement));
    }
}

namespace {

bench::Loudspeaker woofer()
{
    bench::Loudspeaker speaker;
    speaker.Re = 3.98;
    speaker.Le = 5.12e-4;
    speaker.Bl = 8.18;
    speaker.m = 0.0266;
    speaker.Rms = 1.77;
    speaker.K = 2110.0;
    speaker.coneArea = 0.0318;
    return speaker;
}

/// What it shows without noise, the pressure at 1 m times `microphone`. As of few realizations on neighbouring lines,
/// the bass is known better than the rest.
std::vector<ResponseTarget> shownBy(const bench::Loudspeaker& speaker, const std::vector<Quantity>& quantities,
                                    double microphone = 1.0)
{
    std::vector<ResponseTarget> targets(quantities.size());
    for (std::size_t k = 0; k < targets.size(); ++k) {
        targets[k].quantity = quantities[k];
        for (double f = 10.0; f < 5000.0; f *= std::exp2(1.0 / 24.0)) {
            const auto small = speaker.small(f);
            const auto value = quantities[k] == Quantity::current ? small.current
                               : quantities[k] == Quantity::displacement
                                   ? small.displacement
                                   : microphone * radiationPerArea() * speaker.coneArea * small.radiated;
            targets[k].frequency.push_back(f);
            targets[k].value.push_back(value);
            targets[k].deviation.push_back((f < 120.0 ? 0.003 : 0.025) * std::abs(value));
        }
    }
    return targets;
}

}  // namespace

TEST_CASE("The base of a woofer in a box is started as a woofer", "[effects]")
{
    auto speaker = woofer();
    bench::VentedBox box;
    box.stiffness = 515.0;
    box.mass = 0.00423;
    box.resistance = 0.17;
    speaker.ventedBox = box;
    const auto model = startModel(shownBy(speaker, {Quantity::current, Quantity::displacement, Quantity::pressure}),
                                  true, {});
    CHECK(model.path.parameters[0].value == Approx(speaker.coneArea).epsilon(0.3));
    CHECK(std::abs(model.path.parameters[1].value) < 3e-4);  // there is no way to the microphone
    CHECK(model.baseParameter("Bl").value == Approx(speaker.Bl).epsilon(0.2));
    CHECK(model.baseParameter("Le").value == Approx(speaker.Le).epsilon(0.2));
}

TEST_CASE("A microphone may be upside down, whether the mass is known or not", "[effects]")
{
    const std::vector<Quantity> all {Quantity::current, Quantity::displacement, Quantity::pressure},
        few {Quantity::current, Quantity::pressure};
    for (const auto& quantities : {all, few})
        for (const double microphone : {1.0, -1.0}) {
            CAPTURE(quantities.size(), microphone);
            const auto targets = shownBy(woofer(), quantities, microphone);
            const auto model = startModel(targets, true, {});
            CHECK(microphone * model.path.parameters[0].value > 0.0);
            CHECK(responseErrorDb(model, targets.back()) < -40.0);
        }
}

TEST_CASE("A microphone may be far away where the take tells so", "[effects]")
{
    constexpr double distance = 14.0, delay = distance / 343.0;
    auto targets = shownBy(woofer(), {Quantity::current, Quantity::displacement, Quantity::pressure});
    for (std::size_t k = 0; k < targets[2].frequency.size(); ++k) {
        const auto arrival = std::polar(1.0 / distance, -turn * targets[2].frequency[k] * delay);
        targets[2].value[k] *= arrival;
        targets[2].deviation[k] *= std::abs(arrival);
    }
    DriverInfo driver;
    driver.microphoneDistance = distance;
    const auto model = startModel(targets, true, driver);
    CHECK(model.path.parameters[1].value == Approx(delay).epsilon(1e-3));
    CHECK(responseErrorDb(model, targets[2]) < -40.0);
}

TEST_CASE("A box is found from a base that takes its sound for another one", "[effects]")
{
    // Half the band away from the resonance, a base without a port may hear the sound upside down and too late.
    auto speaker = woofer();
    bench::VentedBox box;
    box.stiffness = 0.5 * speaker.K;
    const double tuning = turn * 45.0;
    box.mass = box.stiffness / (tuning * tuning);
    box.resistance = box.mass * tuning / 8.0;
    speaker.ventedBox = box;
    const auto targets = shownBy(speaker, {Quantity::current, Quantity::displacement, Quantity::pressure});
    const auto start = startModel(targets, true, {});
    for (const auto& [sign, late] : {std::pair {-1.0, 1e-3}, std::pair {1.0, 7e-3}}) {
        CAPTURE(sign, late);
        auto model = start;
        model.path.parameters[0].value *= sign;
        model.path.parameters[1].value += late;
        REQUIRE(addByResponse(model, effectNamed("vented-box"), targets).usable());
        CHECK(responseErrorDb(model, targets.back()) < -40.0);
        CHECK(model.path.parameters[0].value == Approx(speaker.coneArea).epsilon(0.01));
        CHECK(std::abs(model.path.parameters[1].value) < 1e-6);
    }
}

TEST_CASE("A leak at the lower end of the band is found where the air is most of the spring", "[effects]")
{
    // Without the leak the base takes the air for its suspension, and the iron about the coil some of what is left.
    std::vector<double> f;
    for (double at = 5.0; at < 20000.0; at *= 1.1)
        f.push_back(at);
    for (const double share : {3.7, 6.0})  // of the air's stiffness to the suspension's
        for (const double tuning : {4.5, 6.4, 8.0})
            for (const double loss : {0.8, 1.2}) {
                CAPTURE(share, tuning, loss);
                auto truth = boxed({share * 2400.0, tuning, 0.0, loss, 0.0, 0.0});
                truth.baseParameter("K").value = 2400.0;
                truth = withEffect(truth, effectNamed("eddy-currents"), truth.components.back().operatingRange);
                truth.components.back().parameters[0].value = 0.0045;
                truth.components.back().parameters[1].value = 0.74;
                const auto responses = respond(truth, {Quantity::current, Quantity::velocity}, f);
                ResponseTarget impedance {Quantity::current, true, f, {}, {}};
                for (const auto& admittance : responses[0].value) {
                    impedance.value.push_back(1.0 / admittance);
                    impedance.deviation.push_back(1.0 / std::abs(admittance));
                }
                ResponseTarget velocity {Quantity::velocity, false, f, responses[1].value, {}};
                velocity.deviation.assign(f.size(), 0.2);
                const std::vector<ResponseTarget> targets {impedance, velocity};
                auto model = startModel(targets, true, {});
                fitResponse(model, targets);
                REQUIRE(addByResponse(model, effectNamed("eddy-currents"), targets).usable());
                REQUIRE(addByResponse(model, effectNamed("vented-box"), targets).usable());
                CHECK(responseErrorDb(model, targets) < -50.0);
                CHECK(isItself(model, model.components.size() - 1));
            }
}

TEST_CASE("Delay, area and the port's share of a sound are found from anywhere", "[effects]")
{
    const auto f = frequencies();
    for (const double tau : {0.0, 0.4e-3, 21e-3})
        for (const double area : {0.02, -0.003})
            for (const double share : {0.0, 0.4, 1.0}) {
                CAPTURE(tau, area, share);
                auto truth = boxed({3000.0, 42.0, 0.1, 0.1, 0.05, 0.0});
                auto& port = truth.components.back().parameters.back();
                port.value = share;
                port.free = true;
                auto& path = truth.path.parameters;
                path[0].value = area;
                path[1].value = tau;
                path[0].free = path[1].free = true;
                auto model = truth;
                const auto response = respond(truth, {Quantity::pressure}, f).front();
                const ResponseTarget sound {Quantity::pressure, false, f, response.value,
                                            std::vector<double>(f.size(), 1e-3)};
                model.path.parameters[0].value = 0.01;
                model.path.parameters[1].value = 3e-3;
                model.components.back().parameters.back().value = 0.0;
                matchSound(model, sound);
                const double step = 0.125 / f.back();  // of its delays
                CHECK(std::abs(model.path.parameters[1].value - tau) <= 0.51 * step);
                CHECK(model.path.parameters[0].value == Approx(area).epsilon(0.1));
                CHECK(model.components.back().parameters.back().value == Approx(share).margin(0.1));
            }
}
