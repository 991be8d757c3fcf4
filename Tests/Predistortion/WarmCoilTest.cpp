// SPDX-License-Identifier: GPL-3.0-or-later
// What a coil's heat must survive: that a host stops and starts, that another engine comes, a bypass, another amount.
#include "Predistortion/Drivers.h"

#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Predistortion/Chain.h"
#include "Engine/Predistortion/Crossfade.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

using namespace excursion;

namespace {

constexpr double warmRate = 24000.0, tone = 300.0;
constexpr RealTimeOptions warmOptions {warmRate, 1};

std::vector<double> warmTone(double seconds, double amplitude, std::size_t from = 0)
{
    std::vector<double> u(static_cast<std::size_t>(seconds * warmRate));
    for (std::size_t n = 0; n < u.size(); ++n)
        u[n] = amplitude * std::sin(2.0 * std::numbers::pi * tone * static_cast<double>(from + n) / warmRate);
    return u;
}

/// The dissertation's driver with a coil that resists more by this share after a while of a tone of this amplitude.
Model heating(double share, double volts, double seconds)
{
    const double ohms = midbass().baseParameter("Re").value;
    OperatingRange visited;
    visited.current = 10.0;
    visited.displacement = xmax;
    visited.velocity = 2.0;
    visited.duration = 10.0;
    auto model = withEffect(midbass(), effectNamed("coil-heating"), visited);
    auto& added = model.components.back();
    // (Re + R) i^2, with the current that the linear driver would have: that is what linearizing makes of it
    const auto take = simulate(midbass(), warmTone(0.5, volts), warmRate, {});
    const auto& i = take.find(Quantity::current)->samples;
    const double current = rms({i.begin() + i.size() / 2, i.end()});
    added.parameters[0].value = share * ohms / (ohms * (1.0 + share) * current * current);
    added.parameters[1].value = std::log10(seconds);
    added.parameters[2].value = 0.0;
    return model;
}

ChainControls warmControls(Mode mode, double fullScale = 10.0) { return {mode, fullScale, 1.0, {}}; }

template <class Engine>
std::vector<double> passed(Engine& engine, std::vector<double> u)
{
    for (std::size_t n = 0; n < u.size(); n += 240)
        engine.process(u.data() + n, u.data() + n, std::min<std::size_t>(240, u.size() - n));
    return u;
}

double rmsOf(const std::vector<double>& u, double from, double to)
{
    return rms({u.begin() + static_cast<std::ptrdiff_t>(from * warmRate),
                u.begin() + static_cast<std::ptrdiff_t>(to * warmRate)});
}

}  // namespace

TEST_CASE("A coil whose resistance has risen is as warm after a host's stop and start", "[chain][protection]")
{
    const auto model = heating(0.3, 10.0, 2.0);
    for (const auto mode : {Mode::linearize, Mode::audition}) {
        INFO(name(mode));
        Chain chain(model, warmOptions, warmControls(mode));
        const auto before = passed(chain, warmTone(20.0, 1.0));
        REQUIRE((mode == Mode::audition || rmsOf(before, 19.8, 20.0) > 1.2 * rmsOf(before, 0.1, 0.2)));
        chain.settle();
        const auto after = passed(chain, warmTone(0.21, 1.0));
        CHECK(rmsOf(after, 0.01, 0.21) == Approx(rmsOf(before, 19.8, 20.0)).epsilon(0.02));
        chain.reset();  // this begins cold
        const auto cold = passed(chain, warmTone(0.21, 1.0));
        CHECK(rmsOf(cold, 0.01, 0.21) == Approx(rmsOf(before, 0.0, 0.2)).epsilon(0.02));
    }
}

TEST_CASE("A coil whose resistance has risen is as warm when another engine takes over", "[chain][protection]")
{
    const auto model = heating(0.3, 10.0, 2.0);
    for (const auto mode : {Mode::linearize, Mode::audition}) {
        INFO(name(mode));
        const auto make = [&](const Model& of) { return std::make_unique<Chain>(of, warmOptions, warmControls(mode)); };
        Crossfade<Chain> crossfade(1200, 1200);
        crossfade.start(make(model));
        const auto before = passed(crossfade, warmTone(20.0, 1.0));
        crossfade.offer(make(withStrong(model, effectNamed("creep"))));  // as a switch of an effect does
        const auto after = passed(crossfade, warmTone(0.4, 1.0));
        CHECK(rmsOf(after, 0.2, 0.4) == Approx(rmsOf(before, 19.8, 20.0)).epsilon(0.02));
        crossfade.collect();
    }
}

TEST_CASE("A coil whose resistance has risen is as warm after a short bypass", "[chain][protection]")
{
    const auto model = heating(0.3, 10.0, 2.0);
    Chain chain(model, warmOptions, warmControls(Mode::linearize));
    const auto before = passed(chain, warmTone(20.0, 1.0));
    for (const auto other : {Mode::bypass, Mode::speaker}) {
        INFO(name(other));
        chain.set(warmControls(other));
        passed(chain, warmTone(0.3, 1.0));
        chain.set(warmControls(Mode::linearize));
        const auto after = passed(chain, warmTone(0.4, 1.0));
        CHECK(rmsOf(after, 0.2, 0.4) == Approx(rmsOf(before, 19.8, 20.0)).epsilon(0.02));
    }
    // It cools in silence, whatever the mode, with its own time constant.
    chain.set(warmControls(Mode::bypass));
    passed(chain, std::vector<double>(static_cast<std::size_t>(2.0 * warmRate), 0.0));
    chain.set(warmControls(Mode::linearize));
    const auto cooler = passed(chain, warmTone(0.3, 1.0));
    const double hot = rmsOf(before, 19.8, 20.0), cold = rmsOf(before, 0.05, 0.1);
    CHECK(rmsOf(cooler, 0.1, 0.15) == Approx(cold + (hot - cold) * 0.4).epsilon(0.03));
}

TEST_CASE("What a loudspeaker is played unprotected counts as heat", "[chain][protection]")
{
    // A quiet tone keeps the coil at 0.9 of the limit, without protection; then a loud one is linearized.
    const auto model = midbass();
    const double ohms = model.baseParameter("Re").value, share = 1.0 - std::exp(-1.0 / warmRate);
    const auto meansOf = [&](const std::vector<double>& volts) {
        const auto take = simulate(model, volts, warmRate, {});
        std::vector<double> means;
        double mean = 0.0;
        for (const double i : take.find(Quantity::current)->samples)
            means.push_back(mean += share * (ohms * i * i - mean));
        return means;
    };
    const double limit = meansOf(warmTone(5.0, 3.0)).back() / 0.9;
    for (const auto mode : {Mode::bypass, Mode::speaker, Mode::distortion}) {
        INFO(name(mode));
        auto controls = warmControls(mode);
        controls.predistortion.powerLimit = limit;
        Chain chain(model, warmOptions, controls);
        auto volts = warmTone(5.0, 0.3);
        passed(chain, volts);
        controls.mode = Mode::linearize;
        chain.set(controls);
        passed(chain, std::vector<double>(2400));  // fades: what is heard of the other mode is not protected
        volts.insert(volts.end(), 2400, 0.0);
        const auto after = passed(chain, warmTone(4.0, 1.0));
        volts.insert(volts.end(), after.begin(), after.end());
        for (auto& sample : volts)
            sample *= 10.0;
        const auto means = meansOf(volts);
        const double most = *std::max_element(means.begin(), means.end());
        INFO(most / limit << " of the limit");
        CHECK(most < 1.01 * limit);
        CHECK(means.back() > 0.85 * limit);
    }
}

TEST_CASE("A coil has the resistance that it was given while nothing was linearized", "[chain][protection]")
{
    const auto model = heating(0.3, 10.0, 2.0);
    const auto rested = [&](Mode mode) {
        Chain chain(model, warmOptions, warmControls(mode));
        passed(chain, warmTone(10.0, 1.0));
        chain.set(warmControls(Mode::linearize));
        return rmsOf(passed(chain, warmTone(0.3, 1.0)), 0.15, 0.3);
    };
    // It is given less than when it is linearized: the voltage does not make up for the resistance.
    const double hot = rested(Mode::linearize);
    for (const auto mode : {Mode::bypass, Mode::speaker, Mode::distortion}) {
        INFO(name(mode));
        CHECK(rested(mode) == Approx(hot).epsilon(0.08));
    }
}

TEST_CASE("An engine that linearizes after a minute of another mode begins as one that always did", "[chain]")
{
    // 0.01 V of direct voltage are nothing, but not their sum over a minute.
    for (const auto mode : {Mode::speaker, Mode::distortion}) {
        INFO(name(mode));
        auto controls = warmControls(mode);
        controls.predistortion.displacementLimit = 4e-3;
        Chain chain(withStrong(midbass(), effectNamed("stiffness")), warmOptions, controls);
        auto u = warmTone(60.0, 0.01);
        for (auto& sample : u)
            sample += 0.001;
        passed(chain, u);
        chain.collectMeters();
        const std::vector<double> next(u.begin(), u.begin() + static_cast<std::ptrdiff_t>(0.5 * warmRate));
        controls.mode = Mode::linearize;
        chain.set(controls);
        const auto after = passed(chain, next);
        Chain other(withStrong(midbass(), effectNamed("stiffness")), warmOptions, controls);
        const auto wanted = passed(other, next);
        CHECK(rmsOf(after, 0.1, 0.4) == Approx(rmsOf(wanted, 0.1, 0.4)).epsilon(0.05));
        CHECK(chain.collectMeters().predistorter.displacementReduction == 0.0);
    }
}

TEST_CASE("An amount that goes back to all of it makes no step, however warm the coil", "[predistortion]")
{
    const auto model = heating(0.8, 10.0, 5.0);
    PredistortionControls controls;
    controls.amount = 0.0;
    Predistorter engine(model, warmOptions, controls);
    passed(engine, warmTone(20.0, 10.0));
    controls.amount = 1.0;
    engine.set(controls);
    const auto after = passed(engine, warmTone(1.0, 10.0));
    const auto bend = [&after](double from, double to) {
        double most = 0.0;
        for (auto n = static_cast<std::size_t>(from * warmRate); n < static_cast<std::size_t>(to * warmRate); ++n)
            most = std::max(most, std::abs(after[n + 1] - 2.0 * after[n] + after[n - 1]));
        return most;
    };
    const double usual = bend(0.8, 0.99);
    INFO(bend(0.1, 0.5) / usual << " times the signal's own");
    CHECK(bend(0.1, 0.5) < 1.1 * usual);
    CHECK(rmsOf(after, 0.15, 0.2) == Approx(rmsOf(after, 0.3, 0.35)).epsilon(0.01));
}

TEST_CASE("A coil that another mode has brought above the limit is led down to it, not silenced", "[chain][protection]")
{
    const auto model = midbass();
    const double ohms = model.baseParameter("Re").value;
    for (const auto mode : {Mode::bypass, Mode::speaker, Mode::distortion}) {
        INFO(name(mode));
        auto controls = warmControls(mode);
        const auto take = simulate(model, warmTone(0.5, 10.0), warmRate, {});
        const auto& i = take.find(Quantity::current)->samples;
        const double current = rms({i.begin() + i.size() / 2, i.end()});
        controls.predistortion.powerLimit = 0.25 * ohms * current * current;
        Chain chain(model, warmOptions, controls);
        passed(chain, warmTone(5.0, 1.0));  // four times the limit
        controls.mode = Mode::linearize;
        chain.set(controls);
        const auto after = passed(chain, warmTone(4.0, 1.0));
        const double end = rmsOf(after, 3.5, 4.0);
        CHECK(end == Approx(0.5 * rmsOf(warmTone(1.0, 1.0), 0.0, 1.0)).epsilon(0.1));
        for (double from = 0.1; from < 3.0; from += 0.1) {
            INFO(from << " s");
            CHECK(rmsOf(after, from, from + 0.1) > 0.2 * end);
        }
    }
}
