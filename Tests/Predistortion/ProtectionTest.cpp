// SPDX-License-Identifier: GPL-3.0-or-later
// What comes out of a predistorter is given to the driver as Loudspeaker/Simulate integrates it, which shares the laws
// with the protection and nothing else: not the inverse, not the reference, not the steps.
#include "Predistortion/Amplified.h"
#include "Predistortion/Drivers.h"
#include "Predistortion/Programme.h"

#include "Engine/Error.h"
#include "Engine/Loudspeaker/ModelFile.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Numerics/Parallel.h"
#include "Engine/Predistortion/DriverMotion.h"
#include "Engine/Predistortion/Foresight.h"
#include "Engine/Predistortion/Linearizer.h"
#include "Engine/Predistortion/Predistorter.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

using namespace excursion;

namespace {

constexpr double rate = 48000.0;

std::vector<Model> factoryModels()
{
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path("Presets") / "drivers"))
        files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    std::vector<Model> models;
    for (const auto& file : files)
        models.push_back(readModel(file));
    return models;
}

/// One of the factory's drivers with every number of its base and every strength changed by up to a factor of 1.5
/// either way.
std::optional<Model> drawnModel(Draw& draw)
{
    static const auto models = factoryModels();
    auto model = models[static_cast<std::size_t>(draw.within(0.0, 6.999))];
    for (auto& component : model.components)
        for (auto& parameter : component.parameters)
            if (&component == &model.components.front() || parameter.strength)
                parameter.value *= std::exp(draw.within(-0.4, 0.4));
    try {
        requireRunnable(model, {rate, 2});
    } catch (const Error&) {
        return std::nullopt;
    }
    return model;
}

/// Every parameter off by that share, up or down.
Model wrong(Model model, double share, Draw& draw)
{
    for (auto& component : model.components)
        for (auto& parameter : component.parameters)
            if (&component == &model.components.front() || parameter.strength)
                parameter.value *= draw.within(0.0, 1.0) < 0.5 ? 1.0 - share : 1.0 + share;
    return model;
}

double resonance(const Model& model)
{
    return std::sqrt(model.baseParameter("K").value / model.baseParameter("m").value) / (2.0 * std::numbers::pi);
}

/// V at which the linear driver goes as far, slowly, as it was measured.
double ratedVoltage(const Model& model)
{
    return measuredDisplacement(model)
           / std::abs(respond(model, {Quantity::displacement}, {0.05 * resonance(model)}).front().value.front());
}

PredistortionControls drawnControls(const Model& model, Draw& draw)
{
    const double rated = ratedVoltage(model), ohms = model.baseParameter("Re").value;
    const int which = static_cast<int>(draw.within(1.0, 7.999));
    PredistortionControls controls;
    if (which & 1)
        controls.displacementLimit = measuredDisplacement(model) * draw.within(0.2, 1.2);
    if (which & 2)
        controls.voltageLimit = rated * std::exp(draw.within(-2.0, 1.5));
    if (which & 4)
        controls.powerLimit = rated * rated / ohms * std::exp(draw.within(-4.0, 1.0));
    if (draw.within(0.0, 1.0) < 0.25)
        controls.amount = draw.within(0.0, 1.0);
    return controls;
}

/// The largest share of each limit that a driver reaches from a sample on.
struct Reached {
    double displacement = 0.0, voltage = 0.0, power = 0.0;
};

/// @param take   the driver's answer to the voltage
/// @param u      V, what came out of the predistorter
/// @param from   sample at which these limits came; asked for from a fifth of a second later on, as the cone has to
/// come back by itself. A mean
///               of the heat that is above its limit has to fall, from half a second later on, nearly as fast as
///                   silence would let it
/// @param to     the first sample that is no longer asked for
Reached reachedBy(const Measurement& take, const std::vector<double>& u, double ohms,
                  const PredistortionControls& limits, std::size_t from, std::size_t to)
{
    const auto& x = take.find(Quantity::displacement)->samples;
    const auto& i = take.find(Quantity::current)->samples;
    Reached reached;
    const std::size_t asked = from + static_cast<std::size_t>(from > 0 ? 0.2 * rate : 0.0),
                      warm = from + static_cast<std::size_t>(from > 0 ? 0.5 * rate : 0.0);
    double heat = 0.0, before = 0.0;
    for (std::size_t n = 0; n < to; ++n) {
        heat += (1.0 - std::exp(-1.0 / (rate * PredistortionControls::averagingTime))) * (ohms * i[n] * i[n] - heat);
        if (n < warm)
            before = heat;
        if (n < asked)
            continue;
        reached.displacement = std::max(reached.displacement, std::abs(x[n]) / limits.displacementLimit);
        reached.voltage = std::max(reached.voltage, std::abs(u[n]) / limits.voltageLimit);
        reached.power = std::max(
            reached.power,
            heat
                / std::max(limits.powerLimit,
                           before * std::exp(-0.7 * (static_cast<double>(n) - static_cast<double>(warm)) / rate)));
    }
    return reached;
}

struct Tally {
    int runs = 0;
    Reached worst;
};

/// One driver with a programme of random kind and level, limits in every combination, changed in the middle of every
/// other run.
struct Run {
    std::string what;
    Reached before, after;
    int faults = 0;
};

std::optional<Run> run(int k, double seconds, double repeating, double error, unsigned seed, bool coupled)
{
    Draw draw(seed + static_cast<unsigned>(k));
    const auto model = k < 7 ? factoryModels()[static_cast<std::size_t>(k)] : drawnModel(draw);
    if (!model)
        return std::nullopt;
    auto first = drawnControls(*model, draw);
    auto second = draw.within(0.0, 1.0) < 0.5 ? drawnControls(*model, draw) : first;
    if (error > 0.0)  // beyond what was measured a law is a guess, whatever the margin
        for (auto* controls : {&first, &second}) {
            controls->margin = error;
            controls->displacementLimit = std::min(controls->displacementLimit, 1.2 * measuredDisplacement(*model));
        }
    const auto programme = drawnProgramme(draw, resonance(*model), rate, seconds);
    const double level = draw.within(-20.0, 20.0), volts = ratedVoltage(*model) * std::pow(10.0, level / 20.0);
    std::ostringstream what;
    what << "driver " << k << " (" << model->name << "), " << programme.name << " at " << level
         << " dB, limits (m, V, W) " << first.displacementLimit << ' ' << first.voltageLimit << ' ' << first.powerLimit
         << " then " << second.displacementLimit << ' ' << second.voltageLimit << ' ' << second.powerLimit
         << ", amount " << first.amount << " then " << second.amount;
    AmplifierCoupling amplifier;
    if (coupled)
        amplifier = {std::exp(draw.within(-0.7, 2.3)), draw.within(0.0, 1.0) < 0.5 ? 1 : 2};
    what << ", amplifier " << amplifier.corner << " Hz, order " << amplifier.order;
    Predistorter engine(*model, {rate, 2, amplifier}, first);
    auto voltage = programme.samples;
    if (programme.repeats)
        voltage.resize(std::min(voltage.size(), static_cast<std::size_t>(repeating * rate)));
    for (auto& sample : voltage)
        sample *= volts;
    const std::size_t change = voltage.size() / 64 / 2 * 64;
    for (std::size_t n = 0; n < voltage.size(); n += 64) {
        if (n == change)
            engine.set(second);
        engine.process(voltage.data() + n, voltage.data() + n, std::min<std::size_t>(64, voltage.size() - n));
    }
    const auto driver = error > 0.0 ? wrong(*model, error, draw) : *model;
    const auto take = simulate(driver, amplified(amplifier, voltage, rate), rate, {});
    const double ohms = driver.baseParameter("Re").value;
    return Run {what.str(), reachedBy(take, voltage, ohms, first, 0, change),
                reachedBy(take, voltage, ohms, second, change, voltage.size()), engine.collectMeters().faults};
}

/// @param repeating  s, for which a programme is played at most that repeats itself
/// @param coupled    behind amplifiers with a high-pass of 0.5 to 10 Hz that is stated
Tally study(int drivers, double seconds, double error, unsigned seed, double repeating = 1e3, bool coupled = false)
{
    std::vector<std::optional<Run>> runs(static_cast<std::size_t>(drivers));
    inParallel(runs.size(), std::thread::hardware_concurrency(), {}, [&](std::size_t k) {
        runs[k] = run(static_cast<int>(k), seconds, repeating, error, seed, coupled);
        return true;
    });
    Tally tally;
    const double most = error > 0.0 ? 1.05 : 1.01;
    for (const auto& one : runs) {
        if (!one)
            continue;
        INFO(one->what);
        for (const auto& reached : {one->before, one->after}) {
            CHECK(reached.displacement < most);
            CHECK(reached.voltage < 1.001);
            CHECK(reached.power < most);
            tally.worst.displacement = std::max(tally.worst.displacement, reached.displacement);
            tally.worst.voltage = std::max(tally.worst.voltage, reached.voltage);
            tally.worst.power = std::max(tally.worst.power, reached.power);
        }
        CHECK(one->faults == 0);
        ++tally.runs;
    }
    return tally;
}

void report(const Tally& tally, double least)
{
    WARN(tally.runs << " runs; at most " << 100.0 * tally.worst.displacement << " % of the excursion's limit, "
                    << 100.0 * tally.worst.voltage << " % of the voltage's, " << 100.0 * tally.worst.power
                    << " % of the power's");
    CHECK(tally.worst.displacement > least);  // not by doing nothing
}

}  // namespace

TEST_CASE("The limits of excursion, voltage and power hold together, whatever is played and however they are changed",
          "[protection][slow]")
{
    report(study(16, 1.5, 0.0, 1), 0.95);
}

TEST_CASE("With its margin the limits hold for a driver whose parameters are all 10 % off", "[protection][slow]")
{
    report(study(10, 1.5, 0.1, 1000), 0.6);
}

TEST_CASE("The limits hold behind amplifiers that pass no constant voltage", "[protection][slow]")
{
    report(study(24, 1.5, 0.0, 4000, 1e3, true), 0.95);
}

TEST_CASE("The limits hold for 57 drivers and 20 s each", "[.minutes][slow]")
{
    // Half of it for what repeats itself every second: the means over a second have settled by then.
    report(study(57, 20.0, 0.0, 1, 10.0), 0.95);
    report(study(57, 20.0, 0.1, 1000, 10.0), 0.65);
}

TEST_CASE("The limits hold for 57 drivers and ten minutes each", "[.nightly][slow]")
{
    report(study(57, 600.0, 0.0, 1), 0.95);
    report(study(57, 600.0, 0.1, 1000), 0.65);
}

TEST_CASE("The power's limit counts the resistance that the coil has, not the one that it had when cold",
          "[protection]")
{
    auto model = withStrong(midbass(), effectNamed("coil-heating"));
    auto& heating = model.components.back();
    const double limit = 30.0, ohms = model.baseParameter("Re").value;
    heating.parameters[0].value = 0.5 * ohms / limit;
    heating.parameters[1].value = 0.0;  // 1 s
    heating.parameters[2].value = 0.0;
    for (const double frequency : {45.0, 300.0}) {
        PredistortionControls controls;
        controls.powerLimit = limit;
        Predistorter engine(model, {rate, 2}, controls);
        std::vector<double> u(static_cast<std::size_t>(8.0 * rate));
        for (std::size_t n = 0; n < u.size(); ++n)
            u[n] = 60.0 * std::sin(2.0 * std::numbers::pi * frequency * static_cast<double>(n) / rate);
        const auto take = simulate(model, through(engine, u), rate, {});
        double rise = 0.0, heat = 0.0, most = 0.0;
        for (const double i : take.find(Quantity::current)->samples) {
            const double power = (ohms + heating.parameters[0].value * rise) * i * i,
                         share = 1.0 - std::exp(-1.0 / rate);  // of a second, as the limit's mean and the coil's rise
            rise += share * (power - rise);
            heat += share * (power - heat);
            most = std::max(most, heat);
        }
        INFO(frequency << " Hz: " << most << " W");
        CHECK(most < 1.01 * limit);
        CHECK(most > 0.8 * limit);
    }
}

TEST_CASE("The meters show the motion of the driver that was given what came out", "[protection]")
{
    const auto model = everything();
    for (const auto& limits : {PredistortionControls {1.0, 3e-3, 12.0}, PredistortionControls {1.0, infinity, 5.0},
                               PredistortionControls {0.0, 3e-3, 12.0}, PredistortionControls {0.3, infinity, 8.0}}) {
        Predistorter engine(model, {rate, 2}, limits);
        Draw draw(5);
        auto u = pinkNoise(draw, 48000);
        for (auto& sample : u)
            sample *= 5.0;
        engine.process(u.data(), u.data(), u.size());
        const auto take = simulate(model, u, rate, {});
        const auto meters = engine.collectMeters();
        CHECK(meters.displacement == Approx(peak(take.find(Quantity::displacement)->samples)).epsilon(0.005));
        CHECK(meters.voltage == Approx(peak(u)).epsilon(1e-12));
        CHECK(meters.voltageReduction > 0.1);
    }
}

TEST_CASE("A linearizer that is told to do nothing simulates the driver", "[protection]")
{
    const auto model = everything();
    const auto u = burst(2.0 * rate, 0.3, 10.0);
    const auto take = simulate(model, u, 2.0 * rate, {});
    for (const double limit : {infinity, 6.0}) {
        Linearizer linearizer(model, 2.0 * rate);
        std::vector<double> x, i, out;
        for (const double sample : u) {
            out.push_back(linearizer.step(sample, 0.0, limit));
            x.push_back(linearizer.cone().motion().x);
            i.push_back(linearizer.current());
        }
        const auto clipped = simulate(model, out, 2.0 * rate, {});
        CHECK(peak(out) == Approx(std::min(limit, peak(u))));
        CHECK(relativeError(x, clipped.find(Quantity::displacement)->samples) < 1e-3);
        CHECK(relativeError(i, clipped.find(Quantity::current)->samples) < 1e-2);
    }
}

TEST_CASE("Limiting adds no treble: what it leaves above 2 kHz is what turning down leaves", "[protection][slow]")
{
    // Of signals without treble: less than -60 dB of what comes out. With treble: no more than came in.
    for (const auto& model : factoryModels()) {
        INFO(model.name);
        const double rated = ratedVoltage(model), f0 = resonance(model);
        PredistortionControls controls;
        controls.displacementLimit = 0.5 * measuredDisplacement(model);
        for (const double frequency : {0.3 * f0, f0, 2.0 * f0}) {
            std::vector<double> u(static_cast<std::size_t>(3.0 * rate));
            for (std::size_t n = 0; n < u.size(); ++n)
                u[n] = 5.0 * rated * std::sin(2.0 * std::numbers::pi * frequency * static_cast<double>(n) / rate)
                       * std::min(1.0, static_cast<double>(n) / rate);
            Predistorter engine(model, {rate, 2}, controls);
            // The first second fades in, then the limit falls to a tenth and comes back.
            auto out = u;
            for (std::size_t n = 0; n < u.size(); n += 64) {
                auto now = controls;
                if (n > u.size() / 3 && n < u.size() * 2 / 3)
                    now.displacementLimit *= 0.2;
                engine.set(now);
                engine.process(u.data() + n, out.data() + n, std::min<std::size_t>(64, u.size() - n));
            }
            REQUIRE(engine.collectMeters().displacementReduction > 6.0);
            INFO(frequency << " Hz, treble " << 10.0 * std::log10(powerAbove(2000.0, out, rate)) << " dB of "
                           << 20.0 * std::log10(rms(out)));
            CHECK(powerAbove(2000.0, out, rate) < 1e-6 * rms(out) * rms(out));
        }
        Draw draw(3);
        auto u = pinkNoise(draw, static_cast<std::size_t>(2.0 * rate));
        for (const double level : {1.0, 4.0, 10.0})
            for (const double limit : {infinity, 1.0, 0.3}) {
                auto loud = u;
                for (auto& sample : loud)
                    sample *= level * rated;
                controls.voltageLimit = limit * rated;
                Predistorter engine(model, {rate, 2}, controls);
                const auto out = through(engine, loud);
                INFO(level << " x rated, limit " << limit);
                CHECK(powerAbove(2000.0, out, rate) < 4.0 * powerAbove(2000.0, loud, rate));
            }
    }
}

TEST_CASE("A cone is foreseen as it will move", "[protection]")
{
    const auto model = everything();
    Reference reference(model, 16.0 * rate), other(model, rate);
    Eigen::VectorXd times(12);
    for (Eigen::Index k = 0; k < times.size(); ++k)
        times[k] = 7.0 * static_cast<double>(k + 1) / rate;
    constexpr Eigen::Index steps = 10;
    const double step = 4.0 / rate, since = 1.5 / rate;
    const Foresight foresight(linearMotion(model, rate), other.basis(), times, steps, step, since);
    Draw draw(8);
    for (int n = 0; n < 5000; ++n)
        reference.step(draw.within(-1.0, 1.0));
    Eigen::VectorXd input(steps);
    for (auto& value : input)
        value = draw.within(-5.0, 5.0);
    const Eigen::VectorXd foreseen = foresight.coasting * reference.state() + foresight.driven * input;
    Eigen::Index next = 0;
    for (int n = 1; next < times.size(); ++n) {
        const double time = n / (16.0 * rate);
        const auto at = static_cast<Eigen::Index>(std::floor((time + since) / step));
        reference.step(at < steps ? input[at] : 0.0);
        if (n % (7 * 16) == 0) {
            CHECK(foreseen[next] == Approx(reference.motion().x).margin(0.01 * foreseen.cwiseAbs().maxCoeff()));
            ++next;
        }
    }
}

TEST_CASE("The lowest band is given up before the next one is touched", "[protection]")
{
    Eigen::MatrixXd parts(2, 3);
    parts << 2.0, 0.5, 0.1, -1.0, 0.4, 0.2;
    const Bands::Values all {1.0, 1.0, 1.0};
    const auto within = [&](double rest, double limit) {
        return largestWithin(Eigen::VectorXd::Constant(2, rest), parts, all, limit);
    };
    CHECK(within(0.0, 3.0) == all);
    CHECK(within(0.0, 1.6) == Bands::Values {0.5, 1.0, 1.0});  // 0.6 + 2 g <= 1.6
    CHECK(within(0.0, 0.35)[0] == 0.0);
    CHECK(within(0.0, 0.35)[1] == Approx(0.375));  // 0.2 + 0.4 g <= 0.35
    CHECK(within(0.0, 0.35)[2] == 1.0);
    CHECK(within(0.0, 0.1) == Bands::Values {0.0, 0.0, 0.5});
    CHECK(within(1.0, 0.5) == Bands::Values {});
    CHECK(within(-0.9, 1.0)[0] == Approx(0.65));  // -0.3 + 2 g <= 1
    // -0.8 - g >= -1, where the lowest band pushes further out
    CHECK(within(-1.4, 1.0)[0] == Approx(0.2));
    // at the first time it would help the others, on which nobody counts
    CHECK(within(-1.7, 1.0)[0] == 0.0);
}
