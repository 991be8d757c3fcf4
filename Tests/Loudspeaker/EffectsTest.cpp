// SPDX-License-Identifier: GPL-3.0-or-later
// Laws that every effect must obey, whatever it is: the catalogue is the list of what is tested.
#include "Loudspeaker/EffectBench.h"

#include "Engine/Error.h"

#include <catch2/catch.hpp>

#include <set>

using namespace excursion;

TEST_CASE("Every effect has words, a name of its own and starts of zero strength", "[effects]")
{
    std::set<std::string> ids;
    for (const auto* effect : catalogue()) {
        INFO(effect->id());
        CHECK(ids.insert(effect->id()).second);
        CHECK(&effectNamed(effect->id()) == effect);
        for (const auto& words : {effect->title(), effect->physics(), effect->symptoms(), effect->remedy()})
            CHECK(!words.empty());
        const OperatingRange operatingRange;
        const auto parameters = effect->parameters(operatingRange);
        CHECK(std::any_of(parameters.begin(), parameters.end(), [](const Parameter& p) { return p.strength; }));
        for (const auto& start : effect->starts(operatingRange)) {
            REQUIRE(start.size() == parameters.size());
            for (std::size_t k = 0; k < start.size(); ++k) {
                CHECK(start[k] >= parameters[k].lower);
                CHECK(start[k] <= parameters[k].upper);
                CHECK((!parameters[k].strength || start[k] == 0.0));
            }
        }
    }
    CHECK_THROWS_AS(effectNamed("gravity"), Error);
}

TEST_CASE("Parts of an effect share no parameter and start at zero strength", "[effects]")
{
    for (const auto* effect : catalogue()) {
        INFO(effect->id());
        const OperatingRange operatingRange;
        const auto parameters = effect->parameters(operatingRange);
        std::size_t next = 0;
        for (const auto& part : effect->parts(operatingRange)) {
            CHECK(effect->linear());
            CHECK(part.first >= next);
            next = part.first + part.count;
            REQUIRE(next <= parameters.size());
            CHECK_FALSE(part.starts.empty());
            for (const auto& start : part.starts) {
                REQUIRE(start.size() == part.count);
                for (std::size_t k = 0; k < part.count; ++k)
                    CHECK((!parameters[part.first + k].strength || start[k] == 0.0));
            }
        }
    }
}

TEST_CASE("An effect of zero strength adds nothing", "[effects]")
{
    for (const auto* effect : catalogue()) {
        INFO(effect->id());
        Alone alone(*effect);
        for (const auto& start : effect->starts(alone.operatingRange)) {
            std::copy(start.begin(), start.end(), alone.parameters.begin());
            alone.prepare();
            // of an effect within another it is a difference, which is what it has been led to
            auto memory = std::vector<double>(alone.rest().size(), effect->host() ? 0.0 : 0.37), rate = memory;
            for (const auto& [i, x, v] : somePoints(alone.operatingRange)) {
                const auto sum = alone.at(i, x, v, memory, &rate);
                for (std::size_t k = 0; k < memory.size(); ++k)
                    memory[k] += 1e-3 * rate[k];
                for (const double part : {sum.inductance, sum.fluxSlope, sum.drop, sum.force, sum.mass})
                    CHECK(part == 0.0);
            }
        }
    }
}

namespace {

/// (1/i) int_0^i d(phi)/di di', by Gauss's rule of five points in each of eight parts.
double fluxPerCurrent(const Alone& alone, double i, double x)
{
    constexpr double node[] {-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831, 0.9061798459386640};
    constexpr double weight[] {0.2369268850561891, 0.4786286704993665, 0.5688888888888889, 0.4786286704993665,
                               0.2369268850561891};
    double sum = 0.0;
    for (int part = 0; part < 8; ++part)
        for (int n = 0; n < 5; ++n)
            sum += weight[n] / 16.0 * alone.at(i * (part + 0.5 + 0.5 * node[n]) / 8.0, x, 0.0).inductance;
    return sum;
}

}  // namespace

TEST_CASE("A law is what the effect adds to the base parameter of that name", "[effects]")
{
    for (const auto* effect : catalogue()) {
        const auto law = effect->law();
        if (!law)
            continue;
        INFO(effect->id());
        const Alone alone(*effect);
        CHECK(std::abs(effect->lawAt(alone.operatingRange, alone.parameters.data(), 0.0))
              < 1e-14 * alone.operatingRange.scale);
        for (const auto& [i, x, v] : somePoints(alone.operatingRange)) {
            const double difference = effect->lawAt(alone.operatingRange, alone.parameters.data(),
                                                    law->argument == "v"   ? v
                                                    : law->argument == "i" ? i
                                                                           : x);
            const auto sum = alone.at(i, x, v);
            const double added = law->base == "Bl"   ? sum.drop / v
                                 : law->base == "Le" ? fluxPerCurrent(alone, i, x)
                                 : law->base == "K"  ? -sum.force / x
                                                     : -sum.force / v;
            CHECK(added == Approx(difference).epsilon(1e-12));
        }
    }
}

TEST_CASE("Jets carry the derivatives that finite differences show, by every parameter and state", "[effects]")
{
    for (const auto* effect : catalogue()) {
        Alone alone(*effect);
        const auto P = alone.parameters.size(), M = alone.rest().size();
        std::vector<double> memory(M);
        for (std::size_t k = 0; k < M; ++k)
            memory[k] = 1e-3 * (0.4 + 0.1 * static_cast<double>(k));
        // Unknowns: the parameters, then i, x, v, then the memory.
        for (const auto& [i, x, v] : somePoints(alone.operatingRange))
            for (std::size_t which = 0; which < P + 3 + M; ++which) {
                INFO(effect->id() << ", unknown " << which);
                const auto evaluate = [&](double by) {
                    Alone moved = alone;
                    std::array<double, 3> motion {i, x, v};
                    auto state = memory;
                    (which < P       ? moved.parameters[which]
                     : which < P + 3 ? motion[which - P]
                                     : state[which - P - 3]) += by;
                    moved.prepare();
                    std::vector<double> result(M);
                    const auto sum = moved.at(motion[0], motion[1], motion[2], state, &result);
                    result.insert(result.end(), {sum.inductance, sum.fluxSlope, sum.drop, sum.force, sum.mass});
                    return result;
                };
                const double size = which < P    ? (alone.parameters[which] != 0.0 ? std::abs(alone.parameters[which])
                                                                                   : 1e-3 * alone.operatingRange.scale)
                                    : which == P ? alone.operatingRange.current
                                    : which == P + 1 ? alone.operatingRange.displacement
                                    : which == P + 2 ? alone.operatingRange.velocity
                                                     : 1e-3;
                const double step = 1e-5 * size;
                const auto above = evaluate(step), below = evaluate(-step), here = evaluate(0.0);

                std::vector<Jet> parameters(alone.parameters.begin(), alone.parameters.end()),
                    state(memory.begin(), memory.end()), rate(M);
                Motion<Jet> motion {Jet(i), Jet(x), Jet(v)};
                Jet& moved = which < P        ? parameters[which]
                             : which == P     ? motion.i
                             : which == P + 1 ? motion.x
                             : which == P + 2 ? motion.v
                                              : state[which - P - 3];
                moved.v[5] = 1.0;
                std::vector<Jet> coefficients(alone.coefficients.size());
                effect->prepare(alone.operatingRange, parameters.data(), coefficients.data());
                Balance<Jet> sum;
                effect->contribute(alone.operatingRange, coefficients.data(), motion, state.data(), rate.data(), sum);
                rate.insert(rate.end(), {sum.inductance, sum.fluxSlope, sum.drop, sum.force, sum.mass});
                for (std::size_t k = 0; k < rate.size(); ++k) {
                    CHECK(rate[k].a == Approx(here[k]).epsilon(1e-12).margin(1e-300));
                    const double slope = (above[k] - below[k]) / (2.0 * step);
                    CHECK(rate[k].v[5] == Approx(slope).epsilon(2e-5).margin(1e-7 * std::abs(here[k]) / size + 1e-13));
                }
            }
    }
}

TEST_CASE("Tangents carry along a motion what jets carry", "[effects]")
{
    for (const auto* effect : catalogue()) {
        const Alone alone(*effect);
        const auto& range = alone.operatingRange;
        const auto M = alone.rest().size();
        // within what was visited, and beyond it
        for (const double reach : {1.0, 1.7, 2.6})
            for (const auto& point : somePoints(range)) {
                const double i = reach * point[0], x = reach * point[1], v = reach * point[2], a = 310.0;
                INFO(effect->id() << " at " << i << " A, " << x << " m, " << v << " m/s");
                const auto sumsOn = [&](auto zero) {
                    using T = decltype(zero);
                    Motion<T> motion {T(i), T(x), T(v)};
                    motion.i.v[1] = 1.0;
                    motion.x.v[0] = v;
                    motion.v.v[0] = a;
                    std::vector<T> memory(M), rate(M),
                        coefficients(alone.coefficients.begin(), alone.coefficients.end());
                    for (std::size_t k = 0; k < M; ++k) {
                        memory[k] = T(1e-3 * (0.4 + 0.1 * static_cast<double>(k)));
                        memory[k].v[0] = 0.2;
                        memory[k].v[1] = -1e-4;
                    }
                    Balance<T> sum;
                    effect->contribute(range, coefficients.data(), motion, memory.data(), rate.data(), sum);
                    rate.insert(rate.end(), {sum.inductance, sum.fluxSlope, sum.drop, sum.force, sum.mass});
                    return rate;
                };
                const auto jets = sumsOn(Jet());
                const auto tangents = sumsOn(Tangent());
                for (std::size_t k = 0; k < jets.size(); ++k) {
                    CHECK(tangents[k].a == Approx(jets[k].a).epsilon(1e-11).margin(1e-15));
                    for (const int slot : {0, 1})
                        CHECK(tangents[k].v[slot] == Approx(jets[k].v[slot]).epsilon(1e-9).margin(1e-12));
                }
            }
    }
}
