// SPDX-License-Identifier: GPL-3.0-or-later
// Effects with a memory or a flux, against what pencil and paper say of them.
#include "Loudspeaker/EffectBench.h"

#include "Bench/Bench.h"
#include "Engine/Loudspeaker/LawMemory.h"
#include "Engine/Loudspeaker/Simulate.h"

#include <catch2/catch.hpp>

using namespace excursion;

namespace {

/// A component of the effect with these values of its parameters.
Component component(const char* id, const OperatingRange& operatingRange, const std::vector<double>& values)
{
    Component result {&effectNamed(id), operatingRange, effectNamed(id).parameters(operatingRange)};
    for (std::size_t k = 0; k < values.size(); ++k)
        result.parameters[k].value = values[k];
    return result;
}

/// Work of the friction over one cycle of x = X cos wt, settled, J.
double lossOfFriction(double frequency, double X, double limit, double reach)
{
    Alone alone(effectNamed("friction"));
    alone.operatingRange.velocity = 2.0 * std::numbers::pi * frequency * X;
    alone.parameters = {limit, reach, 0.0};
    alone.prepare();
    constexpr int steps = 8000, cycles = 16;
    auto memory = alone.rest();
    std::vector<double> rate(memory.size()), later(memory.size()), middle(memory.size());
    const double w = 2.0 * std::numbers::pi * frequency, h = 1.0 / (frequency * steps);
    double work = 0.0;
    for (int n = 0; n < cycles * steps; ++n) {
        const auto at = [&](double t, const std::vector<double>& m, std::vector<double>& out) {
            return alone.at(0.0, X * std::cos(w * t), -w * X * std::sin(w * t), m, &out);
        };
        at(n * h, memory, rate);
        for (std::size_t k = 0; k < memory.size(); ++k)
            middle[k] = memory[k] + 0.5 * h * rate[k];
        const auto sum = at((n + 0.5) * h, middle, later);
        if (n >= (cycles - 1) * steps)
            work += h * sum.force * w * X * std::sin(w * (n + 0.5) * h);
        for (std::size_t k = 0; k < memory.size(); ++k)
            memory[k] += h * later[k];
    }
    return work;
}

double relativeDb(const std::vector<double>& a, const std::vector<double>& b)
{
    double error = 0.0, power = 0.0;
    for (std::size_t n = 0; n < b.size(); ++n) {
        error += (a[n] - b[n]) * (a[n] - b[n]);
        power += b[n] * b[n];
    }
    return 10.0 * std::log10(error / power);
}

/// Three tones under a bell, V.
std::vector<double> tones(double sampleRate, double seconds)
{
    std::vector<double> u(static_cast<std::size_t>(seconds * sampleRate));
    for (std::size_t n = 0; n < u.size(); ++n) {
        const double t = static_cast<double>(n) / sampleRate, bell = (t - 0.5 * seconds) / (0.15 * seconds);
        u[n] = 6.0 * std::exp(-0.5 * bell * bell)
               * (std::sin(2.0 * std::numbers::pi * 40.0 * t) + 0.5 * std::sin(2.0 * std::numbers::pi * 170.0 * t)
                  + 0.3 * std::sin(2.0 * std::numbers::pi * 910.0 * t));
    }
    return u;
}

/// The bench's driver, without effects, as a model.
Model modelOf(const bench::Loudspeaker& speaker)
{
    auto model = makeModel("electrodynamic");
    const std::pair<const char*, double> base[] {{"Re", speaker.Re}, {"Le", speaker.Le},   {"Bl", speaker.Bl},
                                                 {"m", speaker.m},   {"Rms", speaker.Rms}, {"K", speaker.K}};
    for (const auto& [name, value] : base)
        model.baseParameter(name).value = value;
    return model;
}

}  // namespace

TEST_CASE("A cycle of friction loses the area of its loop, 4 Fc (X - r tanh(X/r)), at any frequency", "[effects]")
{
    for (const double X : {0.1e-3, 0.4e-3, 4e-3})
        for (const double frequency : {15.0, 300.0}) {
            INFO(X << " m, " << frequency << " Hz");
            const double limit = 0.7, reach = 3e-4;
            CHECK(lossOfFriction(frequency, X, limit, reach)
                  == Approx(4.0 * limit * (X - reach * std::tanh(X / reach))).epsilon(2e-3));
        }
}

TEST_CASE("A steady current heats the coil by its thermal resistance times its power", "[effects]")
{
    // R = r (1 + share) P with P = (Re + R) i^2
    const double rise = 0.05, share = 0.4, i = 2.0;
    Alone alone(effectNamed("coil-heating"));
    alone.parameters = {rise, -1.0, share, 0.5};
    alone.prepare();
    const double total = rise * (1.0 + share), R = total * alone.operatingRange.scale * i * i / (1.0 - total * i * i);
    const double power = (alone.operatingRange.scale + R) * i * i;
    std::vector<double> rate(2);
    const auto sum = alone.at(i, 0.0, 0.0, {power, power}, &rate);
    CHECK(sum.drop / i == Approx(R).epsilon(1e-12));
    for (const double r : rate)
        CHECK(std::abs(r) < 1e-9 * power);
}

TEST_CASE("The voltage sees the slope of the flux: at a bias d(Le(i) i)/di, which goes on beyond the visited currents",
          "[effects]")
{
    const Alone alone(effectNamed("inductance-current"));
    const double I = alone.operatingRange.current, d = 1e-5 * I;
    const auto flux = [&](double i) {
        return i * alone.effect.lawAt(alone.operatingRange, alone.parameters.data(), i);
    };
    for (const double bias : {-1.7, -0.6, 0.2, 0.95, 1.4})
        CHECK(alone.at(bias * I, 0.0, 0.0).inductance
              == Approx((flux(bias * I + d) - flux(bias * I - d)) / (2.0 * d)).epsilon(1e-6));
    CHECK(alone.at(1.4 * I, 0.0, 0.0).inductance == Approx(alone.at(I, 0.0, 0.0).inductance).epsilon(1e-12));
}

TEST_CASE("A turned element of friction springs back along a line, a knee holds until it lets go", "[effects]")
{
    Alone alone(effectNamed("friction"));
    const double reach = 0.1 * alone.operatingRange.displacement, v = alone.operatingRange.velocity;
    const auto slope = [&](double knee, double turn, double direction, double g) {  // r dg/dx
        alone.parameters = {0.5, reach, 0.0, knee, turn};
        alone.prepare();
        const std::vector<double> memory(4, g);
        std::vector<double> rate(4);
        alone.at(0.0, 0.0, direction * v, memory, &rate);
        return rate[0] * reach / (direction * v);
    };
    for (const double g : {0.1, 0.5, 0.9}) {
        CHECK(slope(0.0, 0.0, 1.0, g) == Approx(1.0 - g));  // Dahl
        CHECK(slope(0.0, 0.0, -1.0, g) == Approx(1.0 + g));
        CHECK(slope(0.0, 0.5, 1.0, g) == Approx(1.0 - g));  // Bouc and Wen
        CHECK(slope(0.0, 0.5, -1.0, g) == Approx(1.0));
        CHECK(slope(0.0, 0.5, 1.0, -g) == Approx(1.0));
        CHECK(slope(1.0, 0.0, 1.0, g) == Approx(1.0 - g * g * g));
    }
    CHECK(slope(0.7, 0.3, 1.0, 1.0) == Approx(0.0).margin(1e-12));  // the limit stays
}

TEST_CASE("An element of friction holds by Dahl's exponent, and more where the cone creeps", "[effects]")
{
    Alone alone(effectNamed("friction"));
    const double reach = 0.1 * alone.operatingRange.displacement, V = alone.operatingRange.velocity;
    // The share of its limit that an element carries when the cone has gone `way` reaches at a steady velocity.
    const auto carried = [&](double bend, double stick, double velocity, double way) {
        alone.parameters = {0.5, reach, 0.0, 0.0, 0.0, bend, stick, 0.0};
        alone.prepare();
        std::vector<double> memory(4, 0.0), rate(4);
        constexpr int steps = 20000;
        for (int n = 0; n < steps; ++n) {  // by the midpoint rule
            const double dt = way * reach / std::abs(velocity) / steps;
            alone.at(0.0, 0.0, velocity, memory, &rate);
            auto middle = memory;
            for (std::size_t k = 0; k < 4; ++k)
                middle[k] += 0.5 * dt * rate[k];
            alone.at(0.0, 0.0, velocity, middle, &rate);
            for (std::size_t k = 0; k < 4; ++k)
                memory[k] += dt * rate[k];
        }
        return memory[0];
    };
    for (const double way : {0.3, 1.0, 3.0}) {
        CHECK(carried(0.0, 0.0, V, way) == Approx(1.0 - std::exp(-way)).epsilon(1e-6));
        CHECK(carried(1.0, 0.0, V, way) == Approx(way / (1.0 + way)).epsilon(1e-6));  // dg = (1 - g)^2 dx/r
        CHECK(carried(1.0, 0.0, -V, way) == Approx(-way / (1.0 + way)).epsilon(1e-6));
    }
    CHECK(carried(-0.5, 0.0, V, 1.0) == Approx(1.0 - 0.25).epsilon(1e-6));  // (1 - g)^(1/2) = 1 - x/(2 r)
    constexpr double far = 30.0;
    for (const double share : {0.05, 0.1, 0.3})  // of V; the limit falls from 1 + b to 1 around V/10
        CHECK(carried(0.0, 0.4, share * V, far)
              == Approx(1.0 + 0.4 * std::exp(-100.0 * share * share)).epsilon(1e-6));
}

TEST_CASE("Friction and heat move the model as they move the virtual bench's loudspeaker", "[effects]")
{
    constexpr double rate = 48000.0;
    const auto u = tones(rate, 1.0);
    bench::Loudspeaker speaker;
    OperatingRange operatingRange;
    operatingRange.displacement = speaker.xmax;
    operatingRange.velocity = 1.0;
    operatingRange.current = 3.0;
    auto model = modelOf(speaker);
    SECTION("friction")
    {
        bench::Friction friction;
        for (int n = 0; n < 4; ++n)
            friction.elements.push_back({0.2 / (4e-4 * std::exp2(n - 1.5)), 0.2});
        speaker.friction = friction;
        model = withEffect(model, effectNamed("friction"), operatingRange);
        const double values[] {0.8, 4e-4, 3.0};
        for (std::size_t k = 0; k < 3; ++k)
            model.components.back().parameters[k].value = values[k];
    }
    SECTION("heat")
    {
        bench::CoilHeating heat;
        heat.coilResistance = 20.0;
        heat.coilCapacity = 0.4 / heat.coilResistance;
        heat.magnetResistance = 8.0;
        heat.magnetCapacity = 0.8 / heat.magnetResistance;
        speaker.coilHeating = heat;
        // The ladder's partial fractions: with a = 1/(Rc Cc), b = 1/(Rc Cm), c = 1/(Rm Cm) its poles solve s^2 + (a + b
        // + c) s + a c = 0.
        const double a = 1.0 / (heat.coilResistance * heat.coilCapacity),
                     b = 1.0 / (heat.coilResistance * heat.magnetCapacity),
                     c = 1.0 / (heat.magnetResistance * heat.magnetCapacity);
        const double half = 0.5 * (a + b + c), root = std::sqrt(half * half - a * c), fast = half + root,
                     slow = half - root;
        // K/W of the pole
        const auto weight = [&](double p, double q) { return (b + c - p) / (q - p) / heat.coilCapacity / p; };
        const double perKelvin = heat.alpha * speaker.Re, rise = perKelvin * weight(fast, slow);
        operatingRange.duration = 1.0;
        model = withEffect(model, effectNamed("coil-heating"), operatingRange);
        const double values[] {rise, -std::log10(fast), weight(slow, fast) / weight(fast, slow), -std::log10(slow)};
        for (std::size_t k = 0; k < 4; ++k)
            model.components.back().parameters[k].value = values[k];
    }
    const auto truth = bench::play(speaker, u, rate, {Quantity::current, Quantity::displacement});
    const auto plain = bench::play(speaker.linear(), u, rate, {Quantity::current, Quantity::displacement});
    SimulationOptions options;
    options.tolerance = 1e-6;
    const auto simulated = simulate(model, u, rate, options);
    for (const auto quantity : {Quantity::current, Quantity::displacement}) {
        INFO(name(quantity));
        const auto& y = truth.find(quantity)->samples;
        CHECK(relativeDb(plain.find(quantity)->samples, y) > -40.0);
        CHECK(relativeDb(simulated.find(quantity)->samples, y) < -90.0);
    }
}

TEST_CASE("A slow memory starts each section where the sections before have left it", "[effects]")
{
    // A steady current: w = P (1 - exp(-t/tau)). Over half a second that curves more than over the window of a tenth,
    // and the start makes up for it: there w = P (1 - exp(-t/tau) S(W)/S(w)) with S(T) = sinh(T/2tau)/(T/2tau).
    constexpr double sampleRate = 1000.0, Re = 4.0, i = 1.5;
    Record record;
    record.sampleRate = sampleRate;
    for (const int n : {1, 0, 2}) {  // in any order
        Section section;
        section.periodic = true;
        section.window = 100;
        section.begin = n;
        section.end = n + 1.0;
        section.middle = n + 0.75;
        record.sections.push_back(section);
    }
    auto operatingRange = someOperatingRange(Re);
    operatingRange.duration = 3.0;
    const double P = Re * i * i;
    auto heat = component("coil-heating", operatingRange, {0.0, std::log10(0.8), 0.3, std::log10(5.0)});
    const std::vector<PeriodicMotion> motions(
        3, {std::vector<double>(100, i), std::vector<double>(100, 0.0), std::vector<double>(100, 0.0)});
    const auto starts = historyOf(heat, record, motions, {0.75, 0.75, 0.25}, false);
    const double times[] {1.0, 0.0, 2.5}, tau[] {0.8, 5.0};
    const auto curved = [](double time, double T) { return std::sinh(0.5 * time / T) / (0.5 * time / T); };
    for (std::size_t n = 0; n < 3; ++n)
        for (const int k : {0, 1})
            CHECK(starts[n].value[k]
                  == Approx(P * (1.0 - std::exp(-times[n] / tau[k]) * curved(0.5, tau[k]) / curved(0.1, tau[k])))
                         .margin(1e-3 * P));
    // Before it has settled a loudspeaker may take another power: as if it had been played to for less time.
    auto weaker = record;
    weaker.sections = {record.sections[1]};
    weaker.sections.front().power = {0.64, 0.64, 0.64, 0.64, 0.64, 1.0, 1.0, 1.0, 1.0, 1.0};
    const auto later = historyOf(heat, weaker, {motions.front()}, {0.25}, false).front();
    for (const int k : {0, 1}) {
        const double settled = 0.64 * (1.0 - std::exp(-0.5 / tau[k]));
        CHECK(later.value[k]
              == Approx(P * (1.0 - (1.0 - settled) * curved(0.5, tau[k]) / curved(0.1, tau[k]))).margin(1e-3 * P));
    }
    // All power comes in the first half of each period. About the mean it brings this swings between -q P and q P with
    // q = tanh(T/4tau), and at rest it begins in the middle of that.
    auto bursts = motions;
    for (auto& burst : bursts)
        for (std::size_t k = 0; k < 100; ++k)
            burst.i[k] = k < 50 ? std::sqrt(2.0) * i : 0.0;
    for (const double middle : {0.75, 0.70}) {  // the drive begins with a period, and in its middle
        const auto swung = historyOf(heat, record, bursts, {middle, middle, middle}, false),
                   steady = historyOf(heat, record, motions, {middle, middle, middle}, false);
        const double begins[] {1.75 - middle, 0.75 - middle, 2.75 - middle};
        for (std::size_t n = 0; n < 3; ++n)
            for (const int k : {0, 1}) {
                const double q = std::tanh(0.025 / tau[k]), above = middle == 0.75 ? -q : q;
                const double left = q * std::exp(-begins[n] / tau[k]) * curved(0.5, tau[k]) / curved(0.1, tau[k]);
                CHECK(swung[n].value[k] - steady[n].value[k] == Approx(P * (left + above)).margin(5e-5 * P));
            }
    }
    heat.parameters[0].value = 0.05;
    const auto with = historyOf(heat, record, motions, {0.75, 0.75, 0.25}, true);
    for (std::size_t p = 0; p < heat.parameters.size(); ++p) {
        const double step = 1e-5;
        const auto moved = [&](double by) {
            auto there = heat;
            there.parameters[p].value += by;
            return historyOf(there, record, motions, {0.75, 0.75, 0.25}, false);
        };
        const auto above = moved(step), below = moved(-step);
        for (std::size_t n = 0; n < 3; ++n) {
            const Eigen::VectorXd slope = (above[n].value - below[n].value) / (2.0 * step);
            CHECK((with[n].gradient.col(static_cast<Eigen::Index>(p)) - slope).norm() <= 1e-6 * slope.norm() + 1e-7);
        }
    }
}

TEST_CASE("Hysteresis starts where a motion that has always gone on has brought it", "[effects]")
{
    // x = X cos: at its largest the loop stands at tanh(X/r).
    const double X = 1e-3, reach = 4e-4, sampleRate = 48000.0, w = 2.0 * std::numbers::pi * sampleRate / 4800.0;
    PeriodicMotion motion;
    for (int n = 0; n < 4800; ++n) {
        motion.i.push_back(0.0);
        motion.x.push_back(X * std::cos(w * n / sampleRate));
        motion.v.push_back(-w * X * std::sin(w * n / sampleRate));
    }
    auto operatingRange = someOperatingRange(1800.0);
    operatingRange.velocity = w * X;
    for (const double size : {1.0, 4.0}) {  // also where one period forgets little
        const auto start = settledMemory(component("friction", operatingRange, {1.0, reach * size, 0.0}), motion, 0,
                                         sampleRate);
        for (Eigen::Index k = 0; k < start.value.size(); ++k)
            CHECK(start.value[k] == Approx(std::tanh(X / (reach * size))).epsilon(2e-3));
    }
}

TEST_CASE("Loops in the iron start where a current that has always gone on has brought them", "[effects]")
{
    // dj/dt = r (i - j) with i = cos wt: j = r^2/(r^2 + w^2) at its crest. The slowest loop takes several periods.
    const double sampleRate = 48000.0, w = 2.0 * std::numbers::pi * sampleRate / 480.0;
    PeriodicMotion motion;
    for (int n = 0; n < 480; ++n) {
        motion.i.push_back(std::cos(w * n / sampleRate));
        motion.x.push_back(0.0);
        motion.v.push_back(0.0);
    }
    auto operatingRange = someOperatingRange(1e-3);
    operatingRange.relaxed = true;
    operatingRange.lowFrequency = 20.0;
    operatingRange.highFrequency = 1e5;  // loops forget within a sample
    const auto coil = component("inductance-position", operatingRange, {});
    const auto size = static_cast<std::size_t>(coil.effect->memorySize(operatingRange));
    const auto coefficients = coefficientsOf(coil, valuesOf(coil));
    const auto rateAt = [&](std::size_t k, double held) {
        std::vector<double> memory(size, 0.0), rate(size);
        memory[k] = held;
        Balance<double> unused;
        coil.effect->contribute(operatingRange, coefficients.data(), {0.0, 0.0, 0.0}, memory.data(), rate.data(),
                                unused);
        return rate[k];
    };
    const auto start = settledMemory(coil, motion, 0, sampleRate);
    REQUIRE(start.value.size() == static_cast<Eigen::Index>(size));
    double slowest = w;
    for (std::size_t k = 0; k < size; ++k) {
        const double r = -rateAt(k, 1.0);
        slowest = std::min(slowest, r);
        CHECK(start.value[static_cast<Eigen::Index>(k)] == Approx(r * r / (r * r + w * w)).epsilon(1e-3).margin(1e-6));
    }
    CHECK(slowest < 0.4 * w / (2.0 * std::numbers::pi));
}
