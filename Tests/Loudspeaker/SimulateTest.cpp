// SPDX-License-Identifier: GPL-3.0-or-later
#include "Loudspeaker/EffectBench.h"

#include "Engine/Error.h"
#include "Engine/Loudspeaker/Dynamics.h"
#include "Engine/Loudspeaker/Radiator.h"
#include "Engine/Loudspeaker/Sensors.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Signal/Fft.h"

#include <catch2/catch.hpp>

#include <complex>
#include <random>

using namespace excursion;

namespace {

using Complex = std::complex<double>;

std::vector<double> values(const Model& model)
{
    const auto theta = parameterVector(model);
    return {theta.begin(), theta.end()};
}

/// The base with laws of position and velocity, not symmetric, that change it by some tens of percent.
Model bent()
{
    auto model = makeModel("electrodynamic");
    const std::pair<const char*, std::vector<double>> laws[] = {{"force-factor", {0.02, -0.12, 0.0, 0.02}},
                                                                {"stiffness", {-0.1, 0.25, 0.0, 0.05}},
                                                                {"inductance-position", {-0.15, 0.02}},
                                                                {"damping-velocity", {0.03, 0.2}}};
    auto operatingRange = someOperatingRange(1.0);
    operatingRange.displacement = 6e-3;  // laws have corners at the ends of what is visited; the bursts stay within
    operatingRange.velocity = 3.0;
    for (const auto& [id, shares] : laws) {
        model = withEffect(model, effectNamed(id), operatingRange);
        auto& component = model.components.back();
        for (std::size_t k = 0; k < shares.size(); ++k)
            component.parameters[k].value = shares[k] * component.operatingRange.scale;
    }
    return model;
}

/// Two tones under a bell: starts and ends in silence and is far from half the sample rate.
std::vector<double> burst(double sampleRate, double seconds, double amplitude, double high = 310.0)
{
    std::vector<double> u(static_cast<std::size_t>(seconds * sampleRate));
    for (std::size_t n = 0; n < u.size(); ++n) {
        const double t = static_cast<double>(n) / sampleRate, bell = (t - 0.4 * seconds) / (0.06 * seconds);
        u[n] = amplitude * std::exp(-0.5 * bell * bell)
               * (std::sin(2.0 * std::numbers::pi * 70.0 * t) + 0.4 * std::sin(2.0 * std::numbers::pi * high * t));
    }
    return u;
}

double largest(const std::vector<double>& a, const std::vector<double>& b)
{
    double result = 0.0;
    for (std::size_t n = 0; n < a.size(); ++n)
        result = std::max(result, std::abs(a[n] - b[n]));
    return result;
}

double peakIn(const std::vector<double>& a) { return largest(a, std::vector<double>(a.size(), 0.0)); }

}  // namespace

TEST_CASE("A linear driver's steady state is its closed-form response", "[simulate]")
{
    constexpr double sampleRate = 48000.0, area = 0.02, distance = 0.5, tau = 1.2e-3;
    constexpr std::size_t N = 2048, periods = 8;
    auto model = makeModel("electrodynamic");
    model.path.parameters[0].value = area;
    model.path.parameters[1].value = tau;
    model.microphoneDistance = distance;
    const double Re = 6.0, Le = 3e-4, Bl = 5.0, m = 1e-2, r = 1.0, k = 2e3;

    const std::vector<std::size_t> lines {1, 2, 3, 5, 9, 20, 51, 166, 340};
    std::vector<double> u(N * periods, 0.0);
    std::mt19937_64 random(5);
    for (const auto line : lines) {
        const double phase = std::uniform_real_distribution<>(0.0, 6.28)(random);
        for (std::size_t n = 0; n < u.size(); ++n)
            u[n] += std::cos(2.0 * std::numbers::pi * static_cast<double>(line * (n % N)) / N + phase);
    }
    SimulationOptions options;
    options.tolerance = 1e-8;
    SimulationSummary summary;
    const auto take = simulate(model, u, sampleRate, options, &summary);
    CHECK(summary.converged);
    CHECK(summary.accuracy <= 1e-8);
    CHECK(take.sampleRate == sampleRate);
    CHECK(take.find(Quantity::voltage)->samples == u);

    const auto spectrum = [&](Quantity q) {
        return fft(std::span(take.find(q)->samples).subspan((periods - 2) * N, N));
    };
    const auto U = fft(std::span(u).first(N));
    const auto i = spectrum(Quantity::current), x = spectrum(Quantity::displacement), v = spectrum(Quantity::velocity),
               a = spectrum(Quantity::acceleration), p = spectrum(Quantity::pressure);
    const auto close = [](Complex value, Complex truth, double tolerance) {
        CHECK(std::abs(value - truth) < tolerance * std::abs(truth));
    };
    for (const auto line : lines) {
        INFO("line " << line);
        const Complex s(0.0, 2.0 * std::numbers::pi * sampleRate * static_cast<double>(line) / N);
        const Complex mechanical = m * s * s + r * s + k;
        const Complex I = U[line] / (Re + s * Le + Bl * Bl * s / mechanical), X = Bl * I / mechanical;
        close(i[line], I, 1e-6);
        close(x[line], X, 1e-6);
        close(v[line], s * X, 1e-6);
        close(a[line], s * s * X, 1e-6);
        // The whole record is delayed at once, and its end is no silence.
        close(p[line], 1.2 * area / (2.0 * std::numbers::pi * distance) * s * s * X * std::exp(-s * tau), 1e-4);
    }
}

TEST_CASE("Halving the step divides the error by sixteen", "[simulate]")
{
    constexpr double sampleRate = 6000.0;
    // its law bends within a fiftieth of the visited range
    auto model = withoutEffect(bent(), "damping-velocity");
    for (auto& component : model.components)
        component.operatingRange.highFrequency = 1300.0;
    const auto u = burst(sampleRate, 0.25, 6.0, 1300.0);
    std::vector<Trajectory> runs(3);
    for (std::size_t n = 0; n < 3; ++n)
        REQUIRE(integrate(model, Drive(u, sampleRate, 1 << n), {}, runs[n]));
    for (const auto channel : {&Trajectory::current, &Trajectory::velocity, &Trajectory::acceleration}) {
        const double first = largest(runs[0].*channel, runs[1].*channel),
                     second = largest(runs[1].*channel, runs[2].*channel);
        INFO("changes " << first << " and " << second);
        CHECK(first / second > 12.0);
        CHECK(first / second < 21.0);
    }
    // Displacement changes by no more than the resampled inputs differ by already, a ten-millionth.
    CHECK(largest(runs[0].displacement, runs[1].displacement) < 3e-6 * peakIn(runs[2].displacement));
}

TEST_CASE("The simulation is that of the classical Runge-Kutta method at a fine step", "[simulate]")
{
    constexpr double sampleRate = 12000.0;
    const auto model = bent();
    const auto u = burst(sampleRate, 0.25, 6.0, 1300.0);
    Trajectory run;
    REQUIRE(integrate(model, Drive(u, sampleRate, 2), {}, run));

    const Drive drive(u, sampleRate, 16);
    const Dynamics<double> dynamics(model, values(model));
    using State = Eigen::VectorXd;
    State z = State::Zero(dynamics.order());
    std::vector<double> displacement, acceleration;
    const auto rates = [&](const State& at, std::size_t half) {
        State result(at.size());
        dynamics.rates(at.data(), drive.at(half), result.data());
        return result;
    };
    const double h = drive.step();
    for (std::size_t half = 0; half < 32 * u.size(); half += 2) {
        const State k1 = rates(z, half), k2 = rates(z + 0.5 * h * k1, half + 1), k3 = rates(z + 0.5 * h * k2, half + 1),
                    k4 = rates(z + h * k3, half + 2);
        if (half % 32 == 0) {
            displacement.push_back(z[1]);
            acceleration.push_back(k1[2]);
        }
        z += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
    }
    CHECK(largest(run.displacement, displacement) < 1e-7 * peakIn(displacement));
    CHECK(largest(run.acceleration, acceleration) < 1e-5 * peakIn(acceleration));
}

TEST_CASE("A coil keeps an inductance where a law leaves it none", "[simulate]")
{
    constexpr double sampleRate = 48000.0;
    auto model = withEffect(makeModel("electrodynamic"), effectNamed("inductance-position"), someOperatingRange(1.0));
    model.components.back().parameters.front().value = -3.0 * model.baseParameter("Le").value;
    const auto u = burst(sampleRate, 0.1, 12.0);
    Trajectory run;
    REQUIRE(integrate(model, Drive(u, sampleRate, 8), {}, run));
    const double x = *std::max_element(run.displacement.begin(), run.displacement.end());
    const double Le = model.baseParameter("Le").value;
    const auto& law = model.components.back();
    CHECK(law.effect->lawAt(law.operatingRange, valuesOf(law).data(), x) < -Le);  // the law says less than none there
    const Dynamics<double> dynamics(model, values(model));
    std::vector<double> z(static_cast<std::size_t>(dynamics.order()), 0.0), rate = z;
    z[1] = x;
    dynamics.rates(z.data(), 1.0, rate.data());
    CHECK(rate[0] == Approx(1.0 / (Le / 20.0)));
}

TEST_CASE("Energy in is energy lost and energy stored, at any time", "[simulate]")
{
    constexpr double sampleRate = 48000.0, h = 1.0 / sampleRate;
    const auto model = bent();
    const auto u = burst(sampleRate, 0.3, 6.0);
    Trajectory run;
    REQUIRE(integrate(model, Drive(u, sampleRate, 8), {}, run));
    const double Re = model.baseParameter("Re").value, m = model.baseParameter("m").value;
    const auto law = [&](const char* effect, const char* base, double q) {
        const auto& component = *model.find(effect);
        std::vector<double> c;
        for (const auto& p : component.parameters)
            c.push_back(p.value);
        return model.baseParameter(base).value + component.effect->lawAt(component.operatingRange, c.data(), q);
    };
    const auto potential = [&](double x) {  // Simpson's rule for int K(x) x dx
        double sum = 0.0;
        constexpr int steps = 40;
        for (int n = 0; n <= steps; ++n) {
            const double at = x * n / steps;
            sum += (n == 0 || n == steps ? 1.0 : n % 2 ? 4.0 : 2.0) * law("stiffness", "K", at) * at;
        }
        return sum * x / steps / 3.0;
    };
    const auto power = [&](std::size_t n) {
        const double i = run.current[n], v = run.velocity[n];
        return u[n] * i - Re * i * i - law("damping-velocity", "Rms", v) * v * v;
    };
    double delivered = 0.0, balance = 0.0, storedMost = 0.0, worst = 0.0;
    for (std::size_t n = 1; n < u.size(); ++n) {
        balance += 0.5 * h * (power(n - 1) + power(n));
        delivered += h * std::max(0.0, u[n] * run.current[n]);
        const double i = run.current[n], x = run.displacement[n], v = run.velocity[n];
        const double stored = 0.5 * m * v * v + potential(x) + 0.5 * law("inductance-position", "Le", x) * i * i;
        storedMost = std::max(storedMost, stored);
        worst = std::max(worst, std::abs(balance - stored));
    }
    CHECK(*std::max_element(run.displacement.begin(), run.displacement.end()) > 1.5e-3);  // the laws are felt
    CHECK(storedMost > 1e-3 * delivered);
    CHECK(worst < 1e-4 * storedMost);
}

TEST_CASE("The steps a sample are enough, and no more than allowed", "[simulate]")
{
    constexpr double sampleRate = 12000.0;
    const auto model = bent();
    const auto u = burst(sampleRate, 0.2, 8.0);
    SimulationOptions options;
    options.tolerance = 1e-6;
    const auto chosen = chooseSubsteps(model, u, sampleRate, options);
    CHECK(chosen.converged);
    CHECK(chosen.accuracy <= 1e-6);
    options.tolerance = 1e-11;
    options.maximumSubsteps = 2;
    const auto capped = chooseSubsteps(model, u, sampleRate, options);
    CHECK(!capped.converged);
    CHECK(capped.substeps <= 2);
    std::string reason;
    options.maximumSubsteps = 0;
    CHECK(!options.isValid(&reason));
    CHECK_THROWS_AS(simulate(model, u, sampleRate, options), Error);
}

TEST_CASE("Only traces that somebody looks at ask for smaller steps", "[simulate]")
{
    // A cone with friction turns sharply: in its acceleration at once, in the current less.
    constexpr double sampleRate = 12000.0;
    auto model = withEffect(makeModel("electrodynamic"), effectNamed("friction"), someOperatingRange(1.0));
    model.components.back().parameters[0].value = 0.5;
    const auto u = burst(sampleRate, 0.4, 4.0);
    SimulationOptions options;
    const auto stepsFor = [&](Trace trace, double tolerance) {
        options.tolerances = {{trace, tolerance}};
        const auto chosen = chooseSubsteps(model, u, sampleRate, options);
        CHECK(chosen.converged);
        return chosen.substeps;
    };
    CHECK(stepsFor(Trace::current, 1e-6) < stepsFor(Trace::acceleration, 1e-6));
    CHECK(stepsFor(Trace::acceleration, 1e-3) < stepsFor(Trace::acceleration, 1e-5));
    options.tolerances = {{Trace::current, 0.0}};
    CHECK(!options.isValid(nullptr));
}

TEST_CASE("A model that runs away is told, not simulated", "[simulate]")
{
    auto model = withEffect(makeModel("electrodynamic"), effectNamed("stiffness"), someOperatingRange(1.0));
    // a spring that pushes outward
    model.components.back().parameters[1].value = -3.0 * model.baseParameter("K").value;
    const auto u = burst(12000.0, 0.05, 40.0);
    CHECK_THROWS_AS(simulate(model, u, 12000.0, {}), Error);
    SimulationOptions options;
    options.maximumSubsteps = 16;
    const auto chosen = chooseSubsteps(model, u, 12000.0, options);
    CHECK_FALSE(chosen.converged);
    CHECK(chosen.substeps == 1);  // shorter steps help no law
}

TEST_CASE("Pressure is the acceleration times rho Sd / (2 pi d), later by tau", "[simulate]")
{
    auto model = makeModel("electrodynamic");
    model.path.parameters[0].value = 0.03;
    model.path.parameters[1].value = 7.0 / 48000.0;
    model.microphoneDistance = 2.0;
    const auto a = burst(48000.0, 0.1, 300.0);
    const std::vector<double> zero(a.size(), 0.0);
    Trajectory run {zero, zero, zero, a, {}, {}, zero};
    Radiator radiator(model);
    const double rest[] {0.0, 0.0, 0.0};
    for (const double acceleration : a) {
        const auto sound = radiator.at(rest, acceleration);
        run.flow.push_back(sound.flow);
        run.lateness.push_back(sound.lateness);
    }
    const auto p = Sensors(model, run, 48000.0).record(Quantity::pressure);
    REQUIRE(p.size() == a.size());
    double worst = 0.0;
    for (std::size_t n = 7; n < a.size(); ++n)
        worst = std::max(worst, std::abs(p[n] - 1.2 * 0.03 / (2.0 * std::numbers::pi * 2.0) * a[n - 7]));
    CHECK(worst < 1e-9);
}
