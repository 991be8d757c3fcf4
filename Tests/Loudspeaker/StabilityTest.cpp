// SPDX-License-Identifier: GPL-3.0-or-later
#include "Loudspeaker/EffectBench.h"

#include "Engine/Loudspeaker/DividedStep.h"
#include "Engine/Loudspeaker/ExponentialStep.h"
#include "Engine/Loudspeaker/StepDivision.h"
#include "Engine/Loudspeaker/Trajectory.h"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <utility>

using namespace excursion;

namespace {

constexpr double fs = 48000.0;

/// A coil in iron whose inductance, as a voltage sees it, falls from L0 to L0/(1 + q) at either end of the visited
/// range.
/// @param Ks  ohm s^a of the iron's loops
Model coilInIron(double q, double Ks, const char* law = "inductance-position")
{
    auto range = someOperatingRange(1.0);
    range.current = 2.0;
    auto model = withEffect(makeModel("electrodynamic"), effectNamed("eddy-currents"), range);
    auto& loops = model.components.back();
    loops.parameters[0].value = Ks;
    constexpr double abovePoles = 1e12;  // Hz
    const auto values = valuesOf(loops);
    const double L0 = model.baseParameter("Le").value
                      + loops.effect->addsTo("Le", loops.operatingRange, values.data(), abovePoles);
    model = withEffect(model, effectNamed(law), range);
    auto& component = model.components.back();
    auto& strength = component.parameters[1].value;  // of the square, T_2
    strength = 1.0;
    const auto unit = valuesOf(component);
    const bool byCurrent = component.effect->law()->argument == "i";
    const double end = byCurrent ? range.current : range.displacement;
    const double atEnd = component.effect->lawAt(component.operatingRange, unit.data(), end);
    // d(i c(i))/di of a square is three times c
    strength = -L0 * q / (1.0 + q) / (byCurrent ? 3.0 * atEnd : atEnd);
    return model;
}

std::vector<double> tones(double seconds, double peak, unsigned seed)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
    std::vector<double> u(static_cast<std::size_t>(seconds * fs), 0.0);
    constexpr int count = 60;
    for (int k = 0; k < count; ++k) {
        const double f = 20.0 * std::pow(6000.0 / 20.0, k / (count - 1.0)), p = phase(random);
        for (std::size_t n = 0; n < u.size(); ++n)
            u[n] += peak / std::sqrt(count) * std::sin(2.0 * std::numbers::pi * f * static_cast<double>(n) / fs + p);
    }
    return u;
}

/// rms of the difference, of the rms of the second
double farApart(const std::vector<double>& a, const std::vector<double>& b)
{
    double difference = 0.0, power = 0.0;
    for (std::size_t n = 0; n < a.size(); ++n) {
        difference += (a[n] - b[n]) * (a[n] - b[n]);
        power += b[n] * b[n];
    }
    return std::sqrt(difference / power);
}

/// A run in steps of one length.
Trajectory undivided(const Model& model, std::span<const double> u, int substeps)
{
    const Drive drive(u, fs, substeps);
    ExponentialStep motion(model, drive.step());
    Trajectory run;
    for (std::size_t n = 0, half = 0; n < u.size(); ++n) {
        run.current.push_back(motion.current());
        run.displacement.push_back(motion.displacement());
        run.velocity.push_back(motion.velocity());
        for (int s = 0; s < substeps; ++s, half += 2)
            motion.step(drive.polynomial(half));
    }
    return run;
}

}  // namespace

TEST_CASE("Loops in the iron ask for no shorter steps, however fast they are", "[stability]")
{
    for (const auto& [law, steps] : {std::pair {"inductance-current", 1}, {"inductance-position", 2}})
        for (const double Ks : {0.02, 0.1, 0.5}) {
            INFO(law << " " << Ks);
            const auto model = coilInIron(0.5, Ks, law);
            if (steps == 1 && Ks > 0.3)  // an explicit method would need more
                CHECK(ExponentialStep(model, 1.0 / fs).fastestLaw() > 1.5 * 2.0 * fs);
            REQUIRE(stableSubsteps(model, fs) <= steps);
            const auto u = tones(0.5, 8.0, 3);
            const auto coarse = undivided(model, u, steps), fine = undivided(model, u, 32);
            CHECK(farApart(coarse.current, fine.current) < 1e-4);
            CHECK(farApart(coarse.displacement, fine.displacement) < 1e-4);
        }
}

TEST_CASE("Long steps bear a coil that loses half of its inductance, and no much larger change", "[stability]")
{
    // what loops in the iron hold is multiplied by 2 q^4 - q^2, which is 1 at q = 1
    CHECK(stableSubsteps(coilInIron(0.9, 0.5, "inductance-current"), fs) == 1);
    const auto model = coilInIron(3.0, 0.5, "inductance-current");
    CHECK(stableSubsteps(model, fs) > 1);
    ExponentialStep step(model, 1.0 / fs);
    CHECK(!step.isStable(step.lawSlopes()));
}

TEST_CASE("What is called stable stays near the fine solution, whatever the laws", "[stability]")
{
    std::mt19937 random(41);
    const auto between = [&](double low, double high) {
        return std::exp(std::uniform_real_distribution<double>(std::log(low), std::log(high))(random));
    };
    int several = 0;
    for (int n = 0; n < 24; ++n) {
        const double q = between(0.1, 6.0), Ks = between(0.01, 1.0);
        auto model = coilInIron(q, Ks, n % 2 ? "inductance-current" : "inductance-position");
        const auto range = model.components.back().operatingRange;
        model = withEffect(model, effectNamed("friction"), range);
        auto& friction = model.components.back();
        friction.parameters[0].value = between(0.01, 0.3) * friction.parameters[0].prior;
        friction.parameters[1].value = between(2.5e-3, 0.2) * range.displacement;
        friction.parameters[3].value = between(0.05, 1.0);
        const int substeps = stableSubsteps(model, fs);
        several += substeps > 1;
        INFO(n << ": q " << q << ", Ks " << Ks << ", " << substeps << " steps");
        const auto u = tones(0.3, 8.0, static_cast<unsigned>(n));
        const auto coarse = undivided(model, u, substeps), fine = undivided(model, u, 64);
        Trajectory divided;
        REQUIRE(integrate(model, Drive(u, fs, 1), {}, divided));
        for (const auto* run : {&coarse, &std::as_const(divided)}) {
            CHECK(farApart(run->current, fine.current) < 0.02);
            CHECK(farApart(run->velocity, fine.velocity) < 0.02);
        }
    }
    CHECK(several > 0);
    CHECK(several < 20);
}

TEST_CASE("A step is divided where a law is steep, and nowhere else", "[stability]")
{
    // a coil that loses nearly all of its inductance at either end, and iron that holds it there
    const auto model = coilInIron(12.0, 0.5);
    const StepDivision division(model, fs, 2);
    const auto range = model.components.back().operatingRange;
    CHECK(division.power(0.0, 0.0, 0.0) == 0);
    CHECK(division.power(range.current, 0.0, range.velocity) == 0);
    for (const double end : {-range.displacement, range.displacement}) {
        const int most = division.power(0.0, end, 0.0);
        CHECK(most >= 2);
        CHECK(division.power(0.0, 0.9 * end, 0.0) == most);
        CHECK(division.power(0.0, 100.0 * end, 0.0) == most);  // it goes on as at the end
    }

    SECTION("hysteresis is fast where the cone is")
    {
        auto held = withEffect(makeModel("electrodynamic"), effectNamed("friction"), range);
        auto& friction = held.components.back();
        friction.parameters[0].value = 0.1 * friction.parameters[0].prior;
        friction.parameters[1].value = 2.5e-3 * range.displacement;
        const StepDivision byFriction(held, fs, 1);
        const int fast = byFriction.power(0.0, 0.0, range.velocity);
        CHECK(fast > 0);
        CHECK(byFriction.power(0.0, 0.0, 0.2 * range.velocity) < fast);
        CHECK(byFriction.power(0.0, 0.0, -range.velocity) == fast);
    }
    SECTION("without laws it is never divided")
    {
        const StepDivision linear(makeModel("electrodynamic"), fs, 1);
        CHECK(linear.power(1e3, 1.0, 1e3) == 0);
    }
}

TEST_CASE("The parts of a step follow its input as the step does", "[stability]")
{
    // Parts of an exact step are exact, so a law that is hardly there may divide the step or not.
    auto model = coilInIron(12.0, 0.5);
    const StepDivision division(model, fs, 2);
    auto& strength = model.components.back().parameters[1].value;
    strength *= 1e-9;
    const StepDivision whole(model, fs, 1);
    DividedStep one(model, whole, 1.0 / fs), parted(model, division, 1.0 / fs);
    const auto range = model.components.back().operatingRange;
    Eigen::VectorXd z;
    one.state(z);
    z[1] = range.displacement;  // where the step is divided
    one.begin(z);
    parted.begin(z);
    REQUIRE(division.power(0.0, z[1], 0.0) > whole.power(0.0, z[1], 0.0));
    const std::array<double, ExponentialStep::terms> u {1.0, -2.0, 0.5, 3.0, -1.0, 0.25, 2.0};
    const double atStart = one.step(u);
    CHECK(parted.step(u) == Approx(atStart).epsilon(1e-9));
    // the laws' own memories are not of the exact part
    CHECK(parted.current() == Approx(one.current()).epsilon(1e-9));
    CHECK(parted.displacement() == Approx(one.displacement()).epsilon(1e-9));
    CHECK(parted.velocity() == Approx(one.velocity()).epsilon(1e-9));
}

TEST_CASE("Twice as many steps are twice as fine wherever the cone is", "[stability]")
{
    const auto model = coilInIron(12.0, 0.5);
    const auto range = model.components.back().operatingRange;
    auto u = tones(0.2, 2.0, 5);
    const double held = 0.9 * range.displacement * model.baseParameter("K").value * model.baseParameter("Re").value
                        / model.baseParameter("Bl").value;
    for (auto& volt : u)
        volt += held;  // the cone is at one end all the time
    const auto truth = undivided(model, u, 128);
    Trajectory one, two;
    REQUIRE(integrate(model, Drive(u, fs, 1), {}, one));
    REQUIRE(integrate(model, Drive(u, fs, 2), {}, two));
    const double change = farApart(one.current, two.current), error = farApart(one.current, truth.current);
    INFO("change " << change << ", error " << error);
    CHECK(change > 0.5 * error);
    CHECK(farApart(two.current, truth.current) < 0.5 * error);
}
