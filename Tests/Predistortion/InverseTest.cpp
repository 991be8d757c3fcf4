// SPDX-License-Identifier: GPL-3.0-or-later
#include "Predistortion/Drivers.h"

#include "Engine/Error.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Predistortion/Inverse.h"
#include "Engine/Predistortion/Predistorter.h"
#include "Engine/Predistortion/Speaker.h"

#include <catch2/catch.hpp>

using namespace excursion;

namespace {

const std::vector<double>& channel(const Measurement& take, Quantity quantity) { return take.find(quantity)->samples; }

Measurement simulated(const Model& model, const std::vector<double>& u, double sampleRate)
{
    SimulationOptions options;
    options.tolerance = 1e-8;
    return simulate(model, u, sampleRate, options);
}

}  // namespace

TEST_CASE("The reference moves as the linear driver does, each derivative that of the one before", "[predistortion]")
{
    constexpr double rate = 96000.0;
    const auto model = linearPart(everything());
    const auto u = burst(rate, 0.3, 5.0);
    const auto truth = simulated(model, u, rate);
    Reference reference(model, rate);
    std::vector<double> x, v, a, j, i;
    for (const double sample : u) {
        const auto point = reference.step(sample);
        x.push_back(point.x);
        v.push_back(point.v);
        a.push_back(point.a);
        j.push_back(point.j);
        i.push_back(point.i);
    }
    CHECK(relativeError(x, channel(truth, Quantity::displacement)) < 1e-6);
    CHECK(relativeError(v, channel(truth, Quantity::velocity)) < 1e-6);
    CHECK(relativeError(a, channel(truth, Quantity::acceleration)) < 1e-6);
    CHECK(relativeError(i, channel(truth, Quantity::current)) < 1e-6);
    std::vector<double> difference(j.size(), 0.0), inner(j.size(), 0.0);
    for (std::size_t n = 2; n + 2 < a.size(); ++n) {
        difference[n] = rate * ((a[n - 2] - a[n + 2]) / 12.0 + (a[n + 1] - a[n - 1]) * 2.0 / 3.0);
        inner[n] = j[n];
    }
    CHECK(relativeError(inner, difference) < 1e-5);
}

TEST_CASE("A driver whose poles coincide has a reference, too", "[predistortion]")
{
    // Without inductance to speak of, critically damped: m s^2 + (Rms + Bl^2/Re) s + K is a square.
    auto model = makeModel("electrodynamic");
    for (const auto& [name, value] :
         {std::pair {"Re", 4.0}, {"Le", 1e-4}, {"Bl", 4.0}, {"m", 0.01}, {"Rms", 1.0}, {"K", 625.0}})
        model.baseParameter(name).value = value;
    model = withStrong(model, effectNamed("creep"));
    model.components.back().parameters[2].value = 0.0;  // and all relaxations alike
    const auto u = burst(48000.0, 0.3, 5.0);
    const auto truth = simulated(model, u, 48000.0);
    Reference reference(model, 48000.0);
    std::vector<double> x;
    for (const double sample : u)
        x.push_back(reference.step(sample).x);
    CHECK(relativeError(x, channel(truth, Quantity::displacement)) < 1e-5);
}

TEST_CASE("The inverse of a linear driver leaves the voltage as it is", "[predistortion]")
{
    for (const int oversampling : {1, 2, 4}) {
        INFO(oversampling);
        Predistorter predistorter(linearPart(everything()), {48000.0, oversampling});
        const auto u = burst(48000.0, 0.3, 5.0);
        CHECK(relativeError(through(predistorter, u), u) < 2e-5);
    }
}

TEST_CASE("A driver without a coil is inverted from force to motion", "[predistortion]")
{
    auto plain = makeModel("mechanical");
    plain.baseParameter("m").value = 0.01;
    plain.baseParameter("Rms").value = 1.0;
    plain.baseParameter("K").value = 2000.0;
    const auto model = withStrong(withStrong(plain, effectNamed("stiffness")), effectNamed("damping-velocity"));
    const auto force = burst(48000.0, 0.3, 4.0);
    const auto wanted = simulated(plain, force, 48000.0), asIs = simulated(model, force, 48000.0);
    Predistorter predistorter(model, {48000.0, 2});
    const auto linearized = simulated(model, through(predistorter, force), 48000.0);
    const auto& x = channel(wanted, Quantity::displacement);
    CHECK(relativeError(channel(asIs, Quantity::displacement), x) > 0.03);
    CHECK(relativeError(channel(linearized, Quantity::displacement), x) < 1e-6);
}

TEST_CASE("The speaker in real time does what a simulation does", "[predistortion]")
{
    for (const double rate : {44100.0, 48000.0, 96000.0}) {
        INFO(rate);
        const auto model = everything();
        const auto u = burst(rate, 0.3, 8.0);
        const auto whole = simulated(model, u, rate), linear = simulated(linearPart(model), u, rate);
        Speaker speaker(model, {rate, 2});
        const auto a = channel(whole, Quantity::acceleration);
        CHECK(relativeError(through(speaker, u), a) < 1e-4);
        double reach = 0.0;
        for (const double x : channel(whole, Quantity::displacement))
            reach = std::max(reach, std::abs(x));
        CHECK(speaker.collectMeters().displacement == Approx(reach).epsilon(1e-3));
        auto distortion = a;
        for (std::size_t n = 0; n < a.size(); ++n)
            distortion[n] -= channel(linear, Quantity::acceleration)[n];
        REQUIRE(rms(distortion) > 0.02 * rms(a));
        speaker.setLinearShareRemoved(1.0);
        speaker.reset();
        CHECK(relativeError(through(speaker, u), distortion) < 2e-3);
    }
}

TEST_CASE("What cannot be run is refused in a sentence", "[predistortion]")
{
    const auto refused = [](Model model, RealTimeOptions options, const std::string& part) {
        try {
            Predistorter predistorter(model, options);
            FAIL("not refused");
        } catch (const Error& error) {
            CHECK(std::string(error.what()).find(part) != std::string::npos);
        }
    };
    refused(midbass(), {48000.0, 3}, "oversampling can be 1, 2 or 4");
    refused(midbass(), {10.0, 2}, "sample rate");
    auto model = midbass();
    model.baseParameter("Bl").value = 0.0;
    refused(model, {}, "Bl");
    model = midbass();
    model.baseParameter("Le").value = 0.0;
    refused(model, {}, "finite");
    model = midbass();
    model.baseParameter("K").value = -100.0;
    refused(model, {}, "not stable");
}
