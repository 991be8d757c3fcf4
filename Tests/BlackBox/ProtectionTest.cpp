// SPDX-License-Identifier: GPL-3.0-or-later
// What comes out of a black box's predistorter is given to the model as its own class simulates it, without any bound:
// excursion, voltage and heat are counted there, not by the meters.
#include "BlackBox/RandomModels.h"
#include "Predistortion/Amplified.h"
#include "Predistortion/Programme.h"

#include "Engine/BlackBox/BlackBoxPredistorter.h"
#include "Engine/BlackBox/BoxMotion.h"
#include "Engine/Linear/Response.h"

#include <catch2/catch.hpp>

#include <limits>
#include <map>

using namespace excursion;

namespace {

constexpr double protectedRate = 48000.0;
constexpr double none = std::numeric_limits<double>::infinity();

struct Known {
    Pnlss model;
    RehearsedBox box;
    double resonance;
};

const Known& known(std::uint64_t seed)
{
    static std::map<std::uint64_t, Known> all;
    if (const auto found = all.find(seed); found != all.end())
        return found->second;
    const auto stimulus = pinkStimulus(1.5);
    const auto model = randomPnlss(seed, protectedRate, stimulus);
    const auto box = boxOf(model, stimulus);
    return all.emplace(seed, Known {model, RehearsedBox(box), BoxMotion(box).linear.resonance}).first->second;
}

Eigen::VectorXd moved(const Pnlss& model, const std::vector<double>& out)
{
    return simulate(model, Eigen::Map<const Eigen::VectorXd>(out.data(), static_cast<Eigen::Index>(out.size()))).col(0);
}

/// Largest running mean of u^2/ohms over a second.
double heatOf(const std::vector<double>& out, double rate, double ohms)
{
    double mean = 0.0, most = 0.0;
    const double share = 1.0 - std::exp(-1.0 / rate);
    for (const double u : out) {
        mean += share * (u * u / ohms - mean);
        most = std::max(most, mean);
    }
    return most;
}

}  // namespace

TEST_CASE("Whatever is played, a black box goes no farther than its limit", "[protection]")
{
    Draw draw(3);
    double worst = 0.0, kept = 0.0;
    for (int run = 0; run < 60; ++run) {
        const auto& one = known(21 + run % 6);
        const double limit = one.box.region.farthest * draw.within(0.15, 0.9);
        PredistortionControls controls;
        controls.displacementLimit = limit;
        if (run % 3 == 1)
            controls.amount = draw.within(0.0, 1.0);
        if (run % 4 == 1)
            controls.voltageLimit = one.box.box.stimulus.peak * draw.within(0.1, 1.0);
        auto programme = drawnProgramme(draw, one.resonance, protectedRate, 1.5);
        const double level = one.box.box.stimulus.peak * std::exp(draw.within(-1.5, 3.0));
        for (auto& sample : programme.samples)
            sample *= level;
        BlackBoxPredistorter predistorter(one.box, protectedRate, controls);
        std::vector<double> out(programme.samples.size());
        predistorter.process(programme.samples.data(), out.data(), out.size());
        const double reached = moved(one.model, out).cwiseAbs().maxCoeff() / limit;
        const auto meters = predistorter.collectMeters();
        INFO("run " << run << ": " << programme.name << " at " << level / one.box.box.stimulus.peak
                    << " of the peak, limit " << limit / one.box.region.farthest << " of the region, amount "
                    << controls.amount << ", " << controls.voltageLimit << " V: reached " << reached << ", told "
                    << meters.displacement / limit);
        CHECK(reached < 1.01);
        CHECK(peakOf(out) <= controls.voltageLimit);
        worst = std::max(worst, reached);
        kept += reached / 60.0;
    }
    INFO("worst " << worst << ", mean " << kept);
    CHECK(kept > 0.5);  // it does not simply turn all down
}

TEST_CASE("Behind an amplifier that is stated a black box keeps to its limit, where it went to 1.6 of it",
          "[protection]")
{
    Draw draw(4);
    double worst = 0.0;
    for (int run = 0; run < 40; ++run) {
        const auto& one = known(21 + run % 6);
        PredistortionControls controls;
        controls.displacementLimit = one.box.region.farthest * draw.within(0.15, 0.9);
        const AmplifierCoupling amplifier {run % 2 == 0 ? 2.0 : 5.0, 1 + run % 2};
        auto programme = drawnProgramme(draw, one.resonance, protectedRate, 1.5);
        const double level = one.box.box.stimulus.peak * std::exp(draw.within(-1.5, 3.0));
        for (auto& sample : programme.samples)
            sample *= level;
        BlackBoxPredistorter predistorter(one.box, protectedRate, controls, amplifier);
        std::vector<double> out(programme.samples.size());
        predistorter.process(programme.samples.data(), out.data(), out.size());
        const double reached = moved(one.model, amplified(amplifier, out, protectedRate)).cwiseAbs().maxCoeff()
                               / controls.displacementLimit;
        INFO("run " << run << ": " << programme.name << " at " << level / one.box.box.stimulus.peak
                    << " of the peak, limit " << controls.displacementLimit / one.box.region.farthest
                    << " of the region, order " << amplifier.order << ": reached " << reached);
        CHECK(reached < 1.01);
        worst = std::max(worst, reached);
    }
    CHECK(worst > 0.9);
}

TEST_CASE("An amplifier before a black box keeps its charge when another predistorter takes over", "[protection]")
{
    const auto& one = known(21);
    const AmplifierCoupling amplifier {2.0, 2};
    BlackBoxPredistorter before(one.box, protectedRate, {}, amplifier), after(one.box, protectedRate, {}, amplifier),
        passed(one.box, protectedRate, {}, amplifier);
    const std::vector<double> constant(96000, 0.1 * one.box.box.stimulus.peak);
    std::vector<double> out(constant.size());
    before.process(constant.data(), out.data(), out.size());
    CHECK(before.warmth().charge[0] == Approx(constant[0]).epsilon(1e-3));
    after.warm(before.warmth());
    CHECK(after.warmth().charge == before.warmth().charge);
    passed.pass(out.data(), out.size());
    CHECK(passed.warmth().charge[0] == Approx(constant[0]).epsilon(1e-3));
    after.reset();
    CHECK(after.warmth().charge[0] == 0.0);
}

TEST_CASE("The heat of a coil that is counted to take all of a black box's voltage keeps its limit", "[protection]")
{
    Draw draw(5);
    for (int run = 0; run < 8; ++run) {
        const auto& one = known(21 + run % 6);
        const double ohms = draw.within(3.0, 8.0), rms = one.box.box.stimulus.rms;
        PredistortionControls controls;
        controls.powerLimit = rms * rms / ohms * std::exp(draw.within(-2.5, -0.3));
        auto programme = drawnProgramme(draw, one.resonance, protectedRate, 3.0);
        for (auto& sample : programme.samples)
            sample *= one.box.box.stimulus.peak * draw.within(0.3, 1.5);
        // Without the resistance nothing is known of the heat
        BlackBoxPredistorter unknown(one.box, protectedRate, controls);
        std::vector<double> out(programme.samples.size());
        unknown.process(programme.samples.data(), out.data(), out.size());
        CHECK(unknown.collectMeters().powerReduction == 0.0);
        const double before = heatOf(out, protectedRate, ohms);
        controls.coilResistance = ohms;
        BlackBoxPredistorter predistorter(one.box, protectedRate, controls);
        predistorter.process(programme.samples.data(), out.data(), out.size());
        const double heat = heatOf(out, protectedRate, ohms);
        INFO("run " << run << ": " << programme.name << ", limit " << controls.powerLimit << " W, without it " << before
                    << " W, with it " << heat << " W");
        CHECK(heat < 1.01 * controls.powerLimit);
        CHECK(heat > 0.3 * std::min(before, controls.powerLimit));
        CHECK(std::abs(predistorter.collectMeters().power - heat) < 0.05 * controls.powerLimit);
    }
}

TEST_CASE("What a black box's loudspeaker is given while the engine rests counts as heat", "[protection]")
{
    const auto& one = known(21);
    const double ohms = 4.0, quiet = 0.05 * one.box.box.stimulus.peak;
    const auto sine = [&](double amplitude, double seconds) {
        std::vector<double> u(static_cast<std::size_t>(seconds * protectedRate));
        for (std::size_t n = 0; n < u.size(); ++n)
            u[n] = amplitude
                   * std::sin(2.0 * std::numbers::pi * 2.0 * one.resonance * static_cast<double>(n) / protectedRate);
        return u;
    };
    PredistortionControls controls;
    controls.coilResistance = ohms;
    controls.powerLimit = 0.5 * quiet * quiet / ohms / 0.9;
    BlackBoxPredistorter predistorter(one.box, protectedRate, controls);
    auto given = sine(quiet, 5.0);
    predistorter.pass(given.data(), given.size());
    auto loud = sine(6.0 * quiet, 3.0);
    predistorter.process(loud.data(), loud.data(), loud.size());
    given.insert(given.end(), loud.begin(), loud.end());
    const double heat = heatOf(given, protectedRate, ohms);
    INFO(heat << " W of " << controls.powerLimit);
    CHECK(heat < 1.01 * controls.powerLimit);
    CHECK(heat > 0.9 * controls.powerLimit);
}

TEST_CASE("What was played before a black box is switched on is no excursion that is asked for", "[protection]")
{
    const auto& one = known(21);
    PredistortionControls controls;
    controls.displacementLimit = one.box.region.farthest;
    BlackBoxPredistorter predistorter(one.box, protectedRate, controls);
    predistorter.turn(false);
    predistorter.reset();
    std::vector<double> u(static_cast<std::size_t>(20.0 * protectedRate), 1e-3 * one.box.box.stimulus.peak);
    predistorter.process(u.data(), u.data(), u.size());
    predistorter.collectMeters();
    predistorter.turn(true);
    std::vector<double> next(static_cast<std::size_t>(0.5 * protectedRate), 1e-3 * one.box.box.stimulus.peak);
    predistorter.process(next.data(), next.data(), next.size());
    CHECK(predistorter.collectMeters().displacementReduction == 0.0);
}

TEST_CASE("A black box that is switched on amid the loudest is kept to its limit from then on", "[protection]")
{
    for (const std::uint64_t seed : {21U, 23U}) {
        const auto& one = known(seed);
        PredistortionControls controls;
        controls.displacementLimit = 0.5 * one.box.region.farthest;
        BlackBoxPredistorter predistorter(one.box, protectedRate, controls);
        predistorter.turn(false);
        predistorter.reset();
        std::vector<double> u(static_cast<std::size_t>(2.0 * protectedRate));
        for (std::size_t n = 0; n < u.size(); ++n)
            u[n] = 0.5 * one.box.box.stimulus.peak
                   * std::sin(2.0 * std::numbers::pi * 0.7 * one.resonance * static_cast<double>(n) / protectedRate);
        std::vector<double> out(u.size());
        const std::size_t on = u.size() / 2;
        predistorter.process(u.data(), out.data(), on);
        predistorter.turn(true);
        predistorter.process(u.data() + on, out.data() + on, u.size() - on);
        const auto x = moved(one.model, out);
        // The cone has to come back by itself.
        const auto from = static_cast<Eigen::Index>(on + 0.1 * protectedRate);
        INFO("seed " << seed << ": before " << x.head(static_cast<Eigen::Index>(on)).cwiseAbs().maxCoeff()
                     << " m, limit " << controls.displacementLimit << " m");
        CHECK(x.head(static_cast<Eigen::Index>(on)).cwiseAbs().maxCoeff() > 1.2 * controls.displacementLimit);
        CHECK(x.tail(x.size() - from).cwiseAbs().maxCoeff() < 1.01 * controls.displacementLimit);
    }
}

TEST_CASE("The margin keeps a loudspeaker within the limit that moves farther than its black box says", "[protection]")
{
    Draw draw(9);
    for (int run = 0; run < 6; ++run) {
        const auto& one = known(21 + run);
        PredistortionControls controls;
        controls.margin = 0.15;
        controls.displacementLimit = 0.5 * one.box.region.farthest;
        auto programme = drawnProgramme(draw, one.resonance, protectedRate, 1.5);
        for (auto& sample : programme.samples)
            sample *= 2.0 * one.box.box.stimulus.peak;
        BlackBoxPredistorter predistorter(one.box, protectedRate, controls);
        std::vector<double> out(programme.samples.size());
        predistorter.process(programme.samples.data(), out.data(), out.size());
        const double farther = 1.15 * moved(one.model, out).cwiseAbs().maxCoeff() / controls.displacementLimit;
        INFO("run " << run << ": " << programme.name << " reached " << farther);
        CHECK(farther < 1.01);
    }
}

TEST_CASE("A model of no excursion keeps voltage and region, and says nothing of an excursion", "[protection]")
{
    auto box = known(22).box.box;
    box.output = "pressure";
    CHECK_FALSE(tellsExcursion(box));
    const RehearsedBox rehearsed(box);
    PredistortionControls controls;
    controls.displacementLimit = 1e-9;
    controls.voltageLimit = 0.3 * box.stimulus.peak;
    BlackBoxPredistorter predistorter(rehearsed, protectedRate, controls);
    Draw draw(2);
    auto u = pinkNoise(draw, 48000);
    for (auto& sample : u)
        sample *= box.stimulus.peak;
    std::vector<double> out(u.size());
    predistorter.process(u.data(), out.data(), out.size());
    CHECK(peakOf(out) <= controls.voltageLimit);
    CHECK(peakOf(out) > 0.5 * controls.voltageLimit);
    const auto meters = predistorter.collectMeters();
    CHECK(meters.displacement == 0.0);
    CHECK(meters.displacementReduction == 0.0);
    CHECK(meters.voltageReduction > 1.0);
}

TEST_CASE("The motion of a black box is foreseen as its linear part has it", "[protection]")
{
    for (const double rate : {4000.0, 12000.0, 48000.0}) {
        const auto stimulus = pinkStimulus(1.5);
        auto model = randomPnlss(24, 48000.0, stimulus);
        model.linear = randomPnlss(24, rate, stimulus).linear;
        const auto box = boxOf(model, stimulus);
        const BoxMotion motion(box);
        const auto moves = [&](double f) { return std::abs(respond(box.linear, {f}).front()(0, 0)); };
        INFO(rate << " Hz: resonance " << motion.linear.resonance << " Hz, off by " << motion.error);
        CHECK(motion.error < (rate < 5000.0 ? 0.05 : 2e-3));
        // Where |w x/u| is largest
        for (const double f : {0.8, 1.25})
            CHECK(f * moves(f * motion.linear.resonance) < moves(motion.linear.resonance));
    }
}

TEST_CASE("Controls of what a black box does not have change nothing", "[protection]")
{
    const auto played = [](const BlackBox& box, const PredistortionControls& controls) {
        const auto& one = known(22);
        BlackBoxPredistorter predistorter({box, one.box.region, one.box.rest, one.box.rehearsal}, protectedRate,
                                          controls);
        Draw draw(2);
        auto u = pinkNoise(draw, 48000);
        for (auto& sample : u)
            sample *= box.stimulus.peak;
        predistorter.process(u.data(), u.data(), u.size());
        CHECK(predistorter.collectMeters().powerReduction == 0.0);
        return u;
    };
    auto force = known(22).box.box, pressure = force;
    force.input = "force";
    PredistortionControls controls, heat;
    heat.powerLimit = 1e-3;
    heat.coilResistance = 6.0;
    CHECK((played(force, heat) == played(force, controls)));
    pressure.output = "pressure";
    controls.coilResistance = 6.0;
    controls.powerLimit = pressure.stimulus.rms * pressure.stimulus.rms / 6.0;
    const auto cooled = [&](double margin) {
        BlackBoxPredistorter predistorter({pressure, known(22).box.region, known(22).box.rest, known(22).box.rehearsal},
                                          protectedRate, controls);
        controls.margin = margin;
        predistorter.set(controls);
        std::vector<double> u(96000);
        for (std::size_t n = 0; n < u.size(); ++n)
            u[n] = pressure.stimulus.peak * std::sin(0.1 * static_cast<double>(n));
        predistorter.process(u.data(), u.data(), u.size());
        CHECK(predistorter.collectMeters().powerReduction > 0.5);
        return u;
    };
    CHECK((cooled(0.3) == cooled(0.0)));
}

TEST_CASE("A black box that is switched on while it still moves is planned for as it moves", "[protection]")
{
    double worst = 0.0;
    for (const std::uint64_t seed : {23U})
        for (int turn = 0; turn < 8; ++turn) {
            const auto& one = known(seed);
            const double f = one.resonance;
            const auto period = static_cast<std::size_t>(protectedRate / f);
            const std::size_t on = 12 * period + static_cast<std::size_t>(turn % 4) * period / 4,
                              flip = on + 200 + static_cast<std::size_t>(turn / 4) * period / 4;
            std::vector<double> u(on + 4 * period);
            for (std::size_t n = 0; n < u.size(); ++n)
                u[n] = 0.3 * one.box.box.stimulus.peak * (n < flip ? 1.0 : -1.0)
                       * std::sin(2.0 * std::numbers::pi * f * static_cast<double>(n) / protectedRate);
            const auto run = [&](double limit) {
                PredistortionControls controls;
                controls.displacementLimit = limit;
                BlackBoxPredistorter predistorter(one.box, protectedRate, controls);
                predistorter.turn(false);
                predistorter.reset();
                std::vector<double> out(u.size());
                predistorter.process(u.data(), out.data(), on);
                predistorter.turn(true);
                predistorter.process(u.data() + on, out.data() + on, u.size() - on);
                return moved(one.model, out);
            };
            const auto before = run(none);
            const double limit = 1.1 * before.head(static_cast<Eigen::Index>(on)).cwiseAbs().maxCoeff();
            const double reached = run(limit).cwiseAbs().maxCoeff() / limit;
            worst = std::max(worst, reached);
        }
    INFO(worst);
    CHECK(worst < 1.01);
}

TEST_CASE("What is far beyond the fit's peak is turned down, not taken for what is no number", "[protection]")
{
    const auto& one = known(22);
    const double peak = one.box.box.stimulus.peak;
    BlackBoxPredistorter predistorter(one.box, protectedRate);
    std::vector<double> u(48000);
    for (std::size_t n = 0; n < u.size(); ++n)
        u[n] = 300.0 * peak * std::sin(2.0 * std::numbers::pi * 300.0 * static_cast<double>(n) / protectedRate);
    auto out = u;
    predistorter.process(u.data(), out.data(), u.size());
    CHECK(predistorter.collectMeters().faults == 0);
    CHECK(peakOf({out.begin() + 24000, out.end()}) > 0.1 * peak);
    CHECK(peakOf(out) <= 1.5 * peak);
}
