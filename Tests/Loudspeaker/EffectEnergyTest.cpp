// SPDX-License-Identifier: GPL-3.0-or-later
// Energy that every effect stores, converts or takes in, whatever it is: the catalogue is the list of what is tested.
#include "Loudspeaker/EffectBench.h"

#include "Engine/Error.h"

#include <catch2/catch.hpp>

#include <set>

using namespace excursion;

TEST_CASE("The coil's flux is a potential: d(inductance)/dx is d(fluxSlope)/di", "[effects]")
{
    for (const auto* effect : catalogue()) {
        INFO(effect->id());
        const Alone alone(*effect);
        const double dx = 1e-4 * alone.operatingRange.displacement, di = 1e-4 * alone.operatingRange.current;
        for (const auto& [i, x, v] : somePoints(alone.operatingRange)) {
            const double byPosition = (alone.at(i, x + dx, v).inductance - alone.at(i, x - dx, v).inductance)
                                      / (2.0 * dx);
            const double byCurrent = (alone.at(i + di, x, v).fluxSlope - alone.at(i - di, x, v).fluxSlope) / (2.0 * di);
            CHECK(byPosition == Approx(byCurrent).epsilon(1e-5).margin(1e-9));
        }
    }
}

TEST_CASE("The force of the current is the motion voltage's twin plus the slope of the magnetic coenergy", "[effects]")
{
    // Power that leaves the circuit through the motion arrives at the cone:
    //     F(i) - F(0) = i d(drop)/dv + d/dx int_0^i phi di',   phi the flux, d(phi)/dx = fluxSlope.
    for (const auto* effect : catalogue()) {
        INFO(effect->id());
        const Alone alone(*effect);
        for (const auto& [i, x, v] : somePoints(alone.operatingRange)) {
            const double dv = 1e-3 * alone.operatingRange.velocity;
            const double motionVoltage = (alone.at(i, x, v + dv).drop - alone.at(i, x, v - dv).drop) / (2.0 * dv);
            double coenergySlope = 0.0;  // Simpson's rule, exact for a flux up to third order in i
            constexpr int steps = 40;
            for (int n = 0; n <= steps; ++n) {
                const double weight = n == 0 || n == steps ? 1.0 : n % 2 ? 4.0 : 2.0;
                coenergySlope += weight * alone.at(i * n / steps, x, v).fluxSlope * i / steps / 3.0;
            }
            const double force = alone.at(i, x, v).force - alone.at(0.0, x, v).force;
            CHECK(force == Approx(i * motionVoltage + coenergySlope).epsilon(1e-8).margin(1e-12));
        }
    }
}

TEST_CASE("Flux that current and position change together is one potential, whose coenergy makes the force",
          "[effects]")
{
    Alone alone(effectNamed("inductance-current"));
    const auto names = alone.effect.parameters(alone.operatingRange);
    double place = 0.3;
    for (std::size_t k = 0; k < names.size(); ++k)
        if (names[k].name.front() == 'q')
            alone.parameters[k] = place *= -0.7;
    alone.prepare();
    const double dx = 1e-4 * alone.operatingRange.displacement, di = 1e-4 * alone.operatingRange.current;
    for (const double bias : {-1.4, -0.7, 0.3, 1.2})  // also beyond the visited currents
        for (const double away : {-0.8, 0.1, 0.6}) {
            const double i = bias * alone.operatingRange.current, x = away * alone.operatingRange.displacement;
            const double byPosition = (alone.at(i, x + dx, 0.0).inductance - alone.at(i, x - dx, 0.0).inductance)
                                      / (2.0 * dx);
            const double byCurrent = (alone.at(i + di, x, 0.0).fluxSlope - alone.at(i - di, x, 0.0).fluxSlope)
                                     / (2.0 * di);
            REQUIRE(std::abs(byCurrent) > 0.0);
            CHECK(byPosition == Approx(byCurrent).epsilon(1e-5));
            const double perCurrent = (alone.at(i + di, x, 0.0).force - alone.at(i - di, x, 0.0).force) / (2.0 * di);
            CHECK(perCurrent == Approx(alone.at(i, x, 0.0).fluxSlope).epsilon(1e-5));
        }
}

TEST_CASE("The reluctance force is the slope of the coenergy 1/2 i^2 L(x)", "[effects]")
{
    const Alone alone(effectNamed("inductance-position"));
    const double dx = 1e-4 * alone.operatingRange.displacement;
    for (const auto& [i, x, v] : somePoints(alone.operatingRange)) {
        const double slope = (alone.at(i, x + dx, v).inductance - alone.at(i, x - dx, v).inductance) / (2.0 * dx);
        CHECK(alone.at(i, x, v).force == Approx(0.5 * i * i * slope).epsilon(1e-5));
    }
}

TEST_CASE("Loops that the coil moves against take from terminals and cone what they store and lose", "[effects]")
{
    // u i - F v = d/dt (c i^2/2 + sum L_n (h_n^2 - j_n^2)/2) + sum L_n ((dh_n/dt)^2 - (dj_n/dt)^2)/p_n, where the
    // current stands still; L_n and p_n are asked of the effect: a loop alone is heard as L_n dh_n/dt at rest.
    Alone alone(effectNamed("inductance-position"));
    const auto names = alone.effect.parameters(alone.operatingRange);
    std::vector<std::size_t> loops;
    double depth = 0.0;
    for (std::size_t p = 0; p < names.size(); ++p)
        if (names[p].name.front() == 's')
            loops.push_back(p);
        else if (names[p].name == "depth")
            depth = alone.parameters[p];
        else if (names[p].name.front() == 'r')
            alone.parameters[p] = 0.2 * static_cast<double>(p % 3);
    alone.prepare();
    REQUIRE(loops.size() * 2 == alone.rest().size());
    std::vector<double> L, rate;
    for (std::size_t n = 0; n < loops.size(); ++n) {
        alone.parameters[loops[n]] = 0.2 + 0.3 * static_cast<double>(n);
        L.push_back(alone.parameters[loops[n]] * alone.operatingRange.scale / std::exp(depth));
        auto memory = alone.rest(), moved = alone.rest();
        memory[2 * n] = 1.0;
        alone.at(0.0, 0.0, 0.0, memory, &moved);
        rate.push_back(-moved[2 * n]);
    }
    alone.prepare();
    std::vector<double> memory(alone.rest().size()), moved(memory.size());
    for (std::size_t k = 0; k < memory.size(); ++k)
        memory[k] = std::sin(1.0 + 3.0 * static_cast<double>(k));
    for (const auto& [i, x, v] : somePoints(alone.operatingRange)) {
        const auto sum = alone.at(i, x, v, memory, &moved);
        const double dx = 1e-4 * alone.operatingRange.displacement;
        const double cSlope = (alone.at(i, x + dx, v).inductance - alone.at(i, x - dx, v).inductance) / (2.0 * dx);
        double balance = 0.5 * cSlope * v * i * i;
        for (std::size_t n = 0; n < loops.size(); ++n) {
            const double h = memory[2 * n], j = memory[2 * n + 1], hRate = moved[2 * n], jRate = moved[2 * n + 1];
            balance += L[n] * (h * hRate - j * jRate + (hRate * hRate - jRate * jRate) / rate[n]);
        }
        const double given = i * (sum.drop + sum.fluxSlope * v) - sum.force * v;
        CHECK(given == Approx(balance).epsilon(1e-5).margin(1e-9));
    }
}

TEST_CASE("The force factor converts without loss: force times velocity is voltage times current", "[effects]")
{
    const Alone alone(effectNamed("force-factor"));
    for (const auto& [i, x, v] : somePoints(alone.operatingRange)) {
        const auto sum = alone.at(i, x, v);
        CHECK(sum.force * v == Approx(sum.drop * i).epsilon(1e-13));
        CHECK(sum.force != 0.0);
    }
}

namespace {

struct Cycle {
    double absorbed = 0.0;   ///< J that the effect takes in over one cycle of a prescribed motion and current
    double exchanged = 0.0;  ///< J that go back and forth
};

/// i = I cos wt, x = X cos(wt + shift), many cycles for the memory, then one that counts. Power taken from the circuit
/// is i (drop + d(phi)/dt), from the cone -F v.
Cycle cycle(const Alone& alone, double frequency, double shift)
{
    constexpr int steps = 200;
    // s: the slowest cells of the memory, and a step that the quickest take
    constexpr double settling = 1.0, fastest = 6e-6;
    auto memory = alone.rest();
    const int cycles = memory.empty() ? 1 : 1 + static_cast<int>(std::ceil(settling * frequency));
    const double w = 2.0 * std::numbers::pi * frequency, h = 1.0 / (frequency * steps);
    const int inner = static_cast<int>(std::ceil(h / fastest));
    const double I = 0.8 * alone.operatingRange.current,
                 X = std::min(0.9 * alone.operatingRange.displacement, 0.9 * alone.operatingRange.velocity / w);
    std::vector<double> k1(memory.size()), k2 = k1, k3 = k1, k4 = k1, stage = k1;
    const auto rates = [&](double t, const std::vector<double>& state, std::vector<double>& rate) {
        return alone.at(I * std::cos(w * t), X * std::cos(w * t + shift), -w * X * std::sin(w * t + shift), state,
                        &rate);
    };
    const auto moved = [&](const std::vector<double>& rate, double by) -> const std::vector<double>& {
        for (std::size_t k = 0; k < memory.size(); ++k)
            stage[k] = memory[k] + by * rate[k];
        return stage;
    };
    Cycle result;
    for (int n = 0; n < cycles * steps; ++n) {
        const double t = n * h;
        if (n >= (cycles - 1) * steps) {
            const auto sum = rates(t, memory, k1);
            const double i = I * std::cos(w * t), v = -w * X * std::sin(w * t + shift), di = -w * I * std::sin(w * t);
            const double electrical = i * (sum.drop + sum.inductance * di + sum.fluxSlope * v),
                         mechanical = -sum.force * v;
            result.absorbed += h * (electrical + mechanical);
            result.exchanged += h * (std::abs(electrical) + std::abs(mechanical));
        }
        if (memory.empty())
            continue;
        for (int s = 0; s < inner; ++s) {
            const double g = h / inner, u = t + s * g;
            rates(u, memory, k1);
            rates(u + 0.5 * g, moved(k1, 0.5 * g), k2);
            rates(u + 0.5 * g, moved(k2, 0.5 * g), k3);
            rates(u + g, moved(k3, g), k4);
            for (std::size_t k = 0; k < memory.size(); ++k)
                memory[k] += g / 6.0 * (k1[k] + 2.0 * (k2[k] + k3[k]) + k4[k]);
        }
    }
    return result;
}

}  // namespace

TEST_CASE("Laws of position and current store energy and give all of it back over a cycle", "[effects]")
{
    for (const auto* effect : catalogue()) {
        const auto law = effect->law();
        if (!law || law->argument == "v")
            continue;
        for (const double shift : {0.0, 0.9, -1.6}) {
            const auto energy = cycle(Alone(*effect), 40.0, shift);
            INFO(effect->id() << ", shift " << shift);
            CHECK(energy.exchanged > 0.0);
            CHECK(std::abs(energy.absorbed) < 1e-10 * energy.exchanged);
        }
    }
}

TEST_CASE("Whatever is no law of position or current takes energy in over a cycle and never gives any", "[effects]")
{
    for (const auto* effect : catalogue()) {
        const auto law = effect->law();
        if (law && law->argument != "v")
            continue;
        Alone alone(*effect);
        if (law) {  // a resistance that grows
            std::fill(alone.parameters.begin(), alone.parameters.end(), 0.0);
            alone.parameters.front() = 0.3 * alone.operatingRange.scale;
            alone.prepare();
        }
        for (const double frequency : {15.0, 200.0})
            for (const double shift : {0.0, -1.6}) {
                INFO(effect->id() << ", " << frequency << " Hz, shift " << shift);
                const auto energy = cycle(alone, frequency, shift);
                // resonators take in next to nothing away from where they ring
                const double least = effect->parts(alone.operatingRange).empty() ? 1e-3 : 0.0;
                if (effect->felt())
                    CHECK(energy.absorbed > least * energy.exchanged);
                else
                    CHECK(energy.exchanged == 0.0);
            }
    }
}
