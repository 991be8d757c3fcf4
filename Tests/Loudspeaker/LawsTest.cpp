// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/Engineering.h"
#include "Engine/Loudspeaker/Laws.h"
#include "Engine/Loudspeaker/Model.h"
#include "Engine/Numerics/LuFactors.h"
#include "Loudspeaker/EffectBench.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

using namespace excursion;

namespace {

Model driverWith(std::initializer_list<const char*> effects)
{
    auto model = makeModel("electrodynamic");
    for (const auto* effect : effects)
        model = withEffect(std::move(model), effectNamed(effect), someOperatingRange(1.0));
    return model;
}

Parameter& parameterOf(Model& model, std::size_t component, std::string_view name)
{
    auto& parameters = model.components[component].parameters;
    return *std::find_if(parameters.begin(), parameters.end(), [&](const Parameter& p) { return p.name == name; });
}

/// Of the first law: its value at rest, and the frequency at which it is told.
std::pair<double, double> atRest(const Model& model)
{
    const auto law = laws(model).front();
    return {law.value[law.value.size() / 2], law.frequency};
}

/// Im u/(w i) of an effect with the coil held at x, as its contributions to the balance say: these are affine in the
/// current and in a memory whose rate is affine in both.
double blockedInductance(const Component& component, double x, double omega)
{
    const auto& effect = *component.effect;
    std::vector<double> coefficients(static_cast<std::size_t>(effect.coefficientCount(component.operatingRange)));
    effect.prepare(component.operatingRange, valuesOf(component).data(), coefficients.data());
    const auto n = effect.memorySize(component.operatingRange);
    double inductance = 0.0;
    const auto probe = [&](double current, const Eigen::VectorXd& memory) {
        Motion<double> motion {};
        motion.x = x;
        motion.i = current;
        Balance<double> sum {};
        Eigen::VectorXd rate = Eigen::VectorXd::Zero(n + 1);
        effect.contribute(component.operatingRange, coefficients.data(), motion, memory.data(), rate.data(), sum);
        inductance = sum.inductance;
        rate[n] = sum.drop;
        return rate;
    };
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(n), byCurrent = probe(1.0, none);
    Eigen::MatrixXd A(n, n);
    Eigen::VectorXd c(n);
    for (Eigen::Index k = 0; k < n; ++k) {
        const Eigen::VectorXd one = probe(0.0, Eigen::VectorXd::Unit(n, k));
        A.col(k) = one.head(n);
        c[k] = one[n];
    }
    const std::complex<double> s {0.0, omega};
    const Eigen::MatrixXcd pencil = s * Eigen::MatrixXcd::Identity(n, n) - A.cast<std::complex<double>>();
    const Eigen::VectorXcd memory = ComplexLu(pencil).solve(byCurrent.head(n).cast<std::complex<double>>().eval());
    const std::complex<double> drop = byCurrent[n] + (c.cast<std::complex<double>>().transpose() * memory).value();
    return inductance + drop.imag() / omega;
}

}  // namespace

TEST_CASE("Beside a suspension that creeps K(x) is the stiffness at the lowest frequency", "[laws]")
{
    auto model = driverWith({"stiffness", "creep"});
    const double K = model.baseParameter("K").value, lowest = model.components[2].operatingRange.lowFrequency;
    CHECK(atRest(model) == std::pair {K, 0.0});  // creep that is not at work
    auto& creep = model.components[2].parameters;
    creep[0].value = 0.5 * K;                   // S
    creep[1].value = std::log10(2.0 * lowest);  // centre
    creep[2].value = creep[3].value = 0.0;      // width, tilt: a single relaxation at twice that frequency
    const auto [value, frequency] = atRest(model);
    CHECK(frequency == lowest);
    CHECK(value == Approx(K + 0.5 * K / 5.0));  // S w^2 / (w^2 + p^2) with p = 2 w
}

TEST_CASE("Beside a suspension that creeps Rms(v) is what the cone loses at resonance", "[laws]")
{
    auto model = driverWith({"damping-velocity", "creep"});
    const double K = model.baseParameter("K").value, Rms = model.baseParameter("Rms").value;
    CHECK(atRest(model) == std::pair {Rms, 0.0});  // creep that is not at work
    const double fast = 100.0, strength = 0.2 * K;
    parameterOf(model, 2, "S").value = strength;
    parameterOf(model, 2, "centre").value = std::log10(fast);
    parameterOf(model, 2, "width").value = parameterOf(model, 2, "tilt").value = 0.0;  // a single relaxation
    const auto [value, frequency] = atRest(model);
    const double stiffness = K + strength * frequency * frequency / (frequency * frequency + fast * fast);
    CHECK(frequency == Approx(std::sqrt(stiffness / model.baseParameter("m").value) / (2.0 * std::numbers::pi)));
    const double w = 2.0 * std::numbers::pi * frequency, p = 2.0 * std::numbers::pi * fast;
    CHECK(value == Approx(Rms + strength * p / (w * w + p * p)));
}

TEST_CASE("Beside eddy currents Le(x) is the inductance of the blocked coil an octave below the highest frequency",
          "[laws]")
{
    auto model = driverWith({"eddy-currents", "inductance-position"});
    const double Le = model.baseParameter("Le").value;
    auto& position = model.components[2];
    parameterOf(model, 2, "c1").value = -0.2 * Le;
    parameterOf(model, 2, "c2").value = 0.1 * Le;
    CHECK(laws(model).front().frequency == 0.0);
    const double K = 0.05, a = 0.6;
    parameterOf(model, 1, "Ks").value = K;
    parameterOf(model, 1, "a").value = a;
    SECTION("of a semi-inductance at rest")
    {
        const auto law = laws(model).front();
        CHECK(law.frequency == 0.5 * position.operatingRange.highFrequency);
        const double w = 2.0 * std::numbers::pi * law.frequency;
        const auto middle = law.value.size() / 2;
        CHECK(law.value[middle]
              == Approx(Le + K * std::pow(w, a - 1.0) * std::sin(0.5 * std::numbers::pi * a)).epsilon(1e-3));
    }
    SECTION("of loops that the coil leaves")
    {
        parameterOf(model, 2, "s1").value = 0.4;
        parameterOf(model, 2, "s3").value = 1.5;
        parameterOf(model, 2, "r3").value = 0.5;
        parameterOf(model, 2, "way").value = GENERATE(0.0, 0.4);
        const auto law = laws(model).front();
        const double w = 2.0 * std::numbers::pi * law.frequency,
                     linear = Le + blockedInductance(model.components[1], 0.0, w);
        for (std::size_t n = 0; n < law.argument.size(); n += 8)
            CHECK(law.value[n] == Approx(linear + blockedInductance(position, law.argument[n], w)));
    }
}

TEST_CASE("What is large for a law stays so when loops in the iron or creep take over the base parameter", "[laws]")
{
    for (const auto* const law : {"inductance-position", "inductance-current"}) {
        auto model = driverWith({"eddy-currents", law});
        parameterOf(model, 1, "Ks").value = 0.05;
        parameterOf(model, 1, "a").value = 0.6;
        auto& Le = model.baseParameter("Le").value;
        resize(model, 2);
        const double before = model.components[2].operatingRange.scale,
                     w = std::numbers::pi * someOperatingRange(1.0).highFrequency;
        const double loops = 0.05 * std::pow(w, -0.4) * std::sin(0.3 * std::numbers::pi);
        CHECK(before == Approx(Le + loops).epsilon(1e-3));
        Le *= 1e-6;
        resize(model, 2);
        CHECK(model.components[2].operatingRange.scale == Approx(loops).epsilon(1e-3));
        auto anew = driverWith({"eddy-currents"});
        anew.components[1] = model.components[1];
        anew.baseParameter("Le").value = Le;
        anew = withEffect(anew, effectNamed(law), someOperatingRange(1.0));
        CHECK(anew.components[2].operatingRange.scale == Approx(loops).epsilon(1e-3));
    }
    auto model = driverWith({"creep", "stiffness"});
    const double K = model.baseParameter("K").value, lowest = model.components[1].operatingRange.lowFrequency;
    parameterOf(model, 1, "S").value = 0.5 * K;
    parameterOf(model, 1, "centre").value = std::log10(2.0 * lowest);
    parameterOf(model, 1, "width").value = parameterOf(model, 1, "tilt").value = 0.0;
    model.baseParameter("K").value = 0.01 * K;
    resize(model, 2);
    CHECK(model.components[2].operatingRange.scale == Approx(0.01 * K + 0.1 * K));
}

TEST_CASE("Beside eddy currents Le(i) has them added, and Bl(x) holds at any frequency", "[laws]")
{
    auto model = driverWith({"eddy-currents", "inductance-current", "force-factor"});
    parameterOf(model, 1, "Ks").value = 0.05;
    const auto found = laws(model);
    REQUIRE(found.size() == 2);
    const auto& [position, current] = std::pair(found[1], found[0]);
    CHECK(position.frequency == 0.0);
    CHECK(position.value.front() == model.baseParameter("Bl").value);
    CHECK(current.value.front()
          == Approx(model.baseParameter("Le").value
                    + blockedInductance(model.components[1], 0.0, 2.0 * std::numbers::pi * current.frequency)));
    CHECK(titleOfLaw(current.info.name, current.frequency) == "Le(i) at " + nominal(4000.0, "Hz"));
    CHECK(titleOfLaw(position.info.name, position.frequency) == "Bl(x)");
}

TEST_CASE("A parameter that a search has left at a rounding of zero does not change a band", "[laws]")
{
    auto model = driverWith({"stiffness", "creep"});
    parameterOf(model, 2, "S").value = 0.2 * model.baseParameter("K").value;
    const auto count = static_cast<Eigen::Index>(parametersOf(model).size());
    model.covariance = Eigen::MatrixXd::Identity(count, count) * 1e-4;
    auto& tilt = parameterOf(model, 2, "tilt");
    const auto widthAt = [&](double value) {
        tilt.value = value;
        return laws(model).front().halfWidth.front();
    };
    const double expected = widthAt(0.0);
    CHECK(expected > 0.0);
    CHECK(widthAt(1e-18) == Approx(expected).epsilon(1e-6));
    CHECK(widthAt(-3e-14) == Approx(expected).epsilon(1e-6));
}
