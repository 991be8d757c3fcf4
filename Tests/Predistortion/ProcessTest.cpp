// SPDX-License-Identifier: GPL-3.0-or-later
// What an audio thread may do to a predistorter or a speaker, and what it must get back.
#include "Predistortion/Drivers.h"

#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Predistortion/Predistorter.h"
#include "Engine/Predistortion/Speaker.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace excursion;

namespace {

constexpr double notANumber = std::numeric_limits<double>::quiet_NaN();

bool allFinite(const std::vector<double>& values)
{
    return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

template <class Engine>
void checkBlocks(Engine make())
{
    auto u = noise(20000, 6.0);
    u[7000] = notANumber;  // so that a fault falls where it falls, too
    auto whole = u, cut = u;
    make().process(whole.data(), whole.data(), whole.size());
    auto engine = make();
    std::mt19937 random(3);
    for (std::size_t n = 0; n < cut.size();) {
        const auto count = std::min<std::size_t>(random() % 5 == 0 ? random() % 3000 : random() % 40, cut.size() - n);
        std::vector<double> out(count + 1, 0.25);
        engine.process(cut.data() + n, out.data(), count);
        CHECK(out[count] == 0.25);
        std::copy(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(count),
                  cut.begin() + static_cast<std::ptrdiff_t>(n));
        n += count;
    }
    CHECK(cut == whole);
    CHECK(engine.collectMeters().faults == 1);
}

/// It has run, and is reset: as a new one.
template <class Engine>
void checkReset(Engine make())
{
    const auto u = burst(48000.0, 0.2, 5.0);
    auto used = make(), fresh = make();
    auto before = noise(5000, 20.0);
    before[4000] = infinity;
    used.process(before.data(), before.data(), before.size());
    used.reset();
    CHECK(through(used, u) == through(fresh, u));
}

template <class Engine>
void checkFaults(Engine make())
{
    for (const double poison : {notANumber, infinity, -infinity, 1e300}) {
        auto engine = make();
        const auto clean = burst(48000.0, 1.0, 5.0);
        auto dirty = clean;
        dirty[10000] = dirty[10003] = poison;
        const auto expected = through(engine, clean);
        engine.reset();
        const auto got = through(engine, dirty);
        CHECK(allFinite(got));
        CHECK(engine.collectMeters().faults >= 1);
        CHECK(peak(got) < 3.0 * peak(expected));
        double late = 0.0;  // once it has been faded back, and the linear driver has settled
        for (std::size_t n = 36000; n < got.size(); ++n)
            late = std::max(late, std::abs(got[n] - expected[n]));
        CHECK(late < 0.02 * peak(expected));
    }
}

Predistorter predistorter() { return {everything(), {48000.0, 2}, {}}; }
Speaker speaker() { return {everything(), {48000.0, 2}}; }

}  // namespace

TEST_CASE("How a signal is cut into blocks does not matter", "[predistortion]")
{
    checkBlocks(predistorter);
    checkBlocks(speaker);
}

TEST_CASE("Reset is as new", "[predistortion]")
{
    checkReset(predistorter);
    checkReset(speaker);
}

TEST_CASE("What is not finite resets, and what comes after is as before", "[predistortion]")
{
    checkFaults(predistorter);
    checkFaults(speaker);
}

/// everything(), with the laws of its coil and spring, in units of which volt, ampere and metre are so many.
Model inUnits(double volts, double amperes, double metres)
{
    const double newtons = volts * amperes / metres;  // power is the same
    auto model = makeModel("electrodynamic");
    const std::pair<const char*, double> base[] {{"Re", 3.3 * volts / amperes},     {"Le", 266e-6 * volts / amperes},
                                                 {"Bl", 4.95 * newtons / amperes},  {"m", 0.01435 * newtons / metres},
                                                 {"Rms", 0.786 * newtons / metres}, {"K", 1852.0 * newtons / metres}};
    for (const auto& [name, value] : base)
        model.baseParameter(name).value = value;
    for (const char* const id : {"force-factor", "stiffness", "inductance-position"}) {
        OperatingRange operatingRange;
        operatingRange.displacement = xmax * metres;
        operatingRange.velocity = 2.0 * metres;
        operatingRange.current = 10.0 * amperes;
        operatingRange.lowFrequency = 15.0;
        operatingRange.highFrequency = 8000.0;
        model = withEffect(model, effectNamed(id), operatingRange);
        auto& added = model.components.back();
        added.parameters[0].value = 0.05 * added.operatingRange.scale;
        added.parameters[1].value = 0.2 * added.operatingRange.scale;
    }
    return model;
}

TEST_CASE("What is played does not depend on the units", "[predistortion]")
{
    const auto played = [](double volts, double amperes, double metres) {
        const auto model = inUnits(volts, amperes, metres);
        Predistorter predistorter(model, {48000.0, 2}, {1.0, 3e-3 * metres, 12.0 * volts, 5.0 * volts * amperes});
        Speaker speaker(model, {48000.0, 2});
        auto bent = through(predistorter, burst(48000.0, 0.5, 10.0 * volts)),
             heard = through(speaker, burst(48000.0, 0.5, 10.0 * volts));
        CHECK(predistorter.collectMeters().faults + speaker.collectMeters().faults == 0);
        for (auto& u : bent)
            u /= volts;
        for (auto& a : heard)
            a /= metres;
        return std::pair {bent, heard};
    };
    const auto [bent, heard] = played(1.0, 1.0, 1.0);
    REQUIRE(peak(bent) > 5.0);
    const double factors[][3] = {{1e-6, 1e6, 1e6}, {1e6, 1e-3, 1e6}, {1e6, 1e6, 1e-6}, {3e5, 2.0, 7e-5}};
    for (const auto& factor : factors) {
        CAPTURE(factor[0], factor[1], factor[2]);
        const auto [otherBent, otherHeard] = played(factor[0], factor[1], factor[2]);
        double bentMiss = 0.0, heardMiss = 0.0;
        for (std::size_t n = 0; n < bent.size(); ++n)
            bentMiss = std::max(bentMiss, std::abs(otherBent[n] - bent[n]));
        for (std::size_t n = 0; n < heard.size(); ++n)
            heardMiss = std::max(heardMiss, std::abs(otherHeard[n] - heard[n]));
        CHECK(bentMiss < 1e-6 * peak(bent));
        CHECK(heardMiss < 1e-6 * peak(heard));
    }
}

TEST_CASE("An empty block is nothing", "[predistortion]")
{
    auto engine = predistorter();
    engine.process(nullptr, nullptr, 0);
    const auto u = burst(48000.0, 0.2, 5.0);
    auto other = predistorter();
    CHECK(through(engine, u) == through(other, u));
}

TEST_CASE("Around what is not finite there is silence, without a step", "[predistortion]")
{
    auto engine = predistorter();
    auto u = std::vector<double>(30000);
    for (std::size_t n = 0; n < u.size(); ++n)
        u[n] = 5.0 * std::sin(2.0 * std::numbers::pi * 40.0 * static_cast<double>(n) / 48000.0);
    auto dirty = u;
    dirty[15000] = notANumber;
    dirty = through(engine, dirty);
    double steepest = 0.0, usual = 0.0;
    for (std::size_t n = 10000; n < u.size(); ++n) {
        steepest = std::max(steepest, std::abs(dirty[n] - dirty[n - 1]));
        usual = std::max(usual, std::abs(u[n] - u[n - 1]));
    }
    CHECK(steepest < 6.0 * usual);
    CHECK(rms({dirty.begin() + 15400, dirty.begin() + 15800}) < 0.02);  // the cone has come to rest
    CHECK(rms({dirty.end() - 4800, dirty.end()}) > 3.0);                // and it comes back
}

TEST_CASE("The amount goes from the signal as it is to all of the linearization", "[predistortion]")
{
    const auto u = burst(48000.0, 0.3, 6.0);
    PredistortionControls controls;
    const auto at = [&](double amount) {
        controls.amount = amount;
        Predistorter engine(everything(), {48000.0, 2}, controls);
        return through(engine, u);
    };
    const auto none = at(0.0), half = at(0.5), all = at(1.0);
    CHECK(relativeError(none, u) < 1e-5);
    CHECK(relativeError(all, u) > 0.02);
    auto between = u;
    for (std::size_t n = 0; n < u.size(); ++n)
        between[n] = 0.5 * (none[n] + all[n]);
    CHECK(relativeError(half, between) < 1e-5);
}

TEST_CASE("The limits hold, whatever comes and whatever the amount", "[predistortion]")
{
    for (const double amount : {0.0, 1.0}) {
        INFO(amount);
        Predistorter engine(everything(), {48000.0, 2}, {amount, 3e-3, 12.0});
        CHECK(peak(through(engine, noise(20000, 40.0))) <= 12.0);
        CHECK(engine.collectMeters().voltageReduction > 0.0);
    }
    // Much too loud for the limit: the driver itself, simulated, stays within it.
    const auto u = burst(48000.0, 0.4, 16.0);
    const auto reach = [&](const std::vector<double>& voltage) {
        return peak(simulate(everything(), voltage, 48000.0, {}).find(Quantity::displacement)->samples);
    };
    REQUIRE(reach(u) > 4.5e-3);
    Predistorter engine(everything(), {48000.0, 2}, {1.0, 3e-3, infinity});
    CHECK(reach(through(engine, u)) < 3.01e-3);
    const auto meters = engine.collectMeters();
    CHECK(meters.displacement < 3e-3);
    CHECK(meters.displacementReduction > 2.3);
    Predistorter idle(everything(), {48000.0, 2}, {0.0, 3e-3, infinity});
    CHECK(reach(through(idle, u)) < 3.03e-3);
}

TEST_CASE("Controls are followed smoothly, and those that make no sense are left", "[predistortion]")
{
    auto engine = predistorter();
    std::vector<double> u(20000);
    for (std::size_t n = 0; n < u.size(); ++n)
        u[n] = 6.0 * std::sin(2.0 * std::numbers::pi * 50.0 * static_cast<double>(n) / 48000.0);
    auto out = u;
    for (std::size_t n = 0; n < u.size(); n += 500) {
        engine.set(n % 1000 == 0 ? PredistortionControls {0.0, 10e-3, 50.0}
                                 : PredistortionControls {1.0, 3.5e-3, 30.0});
        engine.set({notANumber, -1.0, 0.0});
        engine.process(u.data() + n, out.data() + n, 500);
    }
    double steepest = 0.0;
    for (std::size_t n = 1; n < out.size(); ++n)
        steepest = std::max(steepest, std::abs(out[n] - out[n - 1]));
    CHECK(allFinite(out));
    CHECK(steepest < 0.2);  // the sine alone has 0.04
}

TEST_CASE("Silence comes out as silence, not as subnormal numbers", "[predistortion]")
{
    auto bend = predistorter();
    auto play = speaker();
    for (int round = 0; round < 2; ++round) {
        auto u = round == 0 ? burst(48000.0, 0.1, 5.0) : std::vector<double>(48000, 1e-310);
        u.resize(60000, 0.0);
        auto v = u;
        bend.process(u.data(), u.data(), u.size());
        play.process(v.data(), v.data(), v.size());
        for (const auto* out : {&u, &v})
            CHECK(std::none_of(out->begin(), out->end(),
                               [](double value) { return std::fpclassify(value) == FP_SUBNORMAL; }));
    }
}

TEST_CASE("No model and no signal makes the inverse run away", "[predistortion]")
{
    // Laws as a bad fit may leave them: a force factor that vanishes and turns over, a stiffness and an inductance that
    // become negative.
    for (const auto& [id, factor] : {std::pair {"force-factor", -1.6},
                                     {"stiffness", -1.5},
                                     {"inductance-position", -1.5},
                                     {"damping-velocity", -1.5}}) {
        INFO(id);
        auto model = withoutEffect(everything(), id);
        model = withStrong(model, effectNamed(id));
        auto& law = model.components.back();
        law.parameters[0].value = 0.3 * law.operatingRange.scale;
        law.parameters[1].value = factor * law.operatingRange.scale;
        for (const double level : {5.0, 100.0, 1e4}) {
            INFO(level);
            Predistorter limited(model, {48000.0, 2}, {1.0, xmax, 50.0}), free(model, {48000.0, 2}, {});
            const auto u = noise(20000, level, 5), slow = burst(48000.0, 0.4, level);
            for (const auto* signal : {&u, &slow}) {
                CHECK(peak(through(limited, *signal)) <= 50.0);
                CHECK(allFinite(through(free, *signal)));
            }
            // and it comes back
            limited.reset();
            const auto quiet = burst(48000.0, 1.0, 0.01);
            CHECK(relativeError(through(limited, quiet), quiet) < 0.01);
        }
    }
}
