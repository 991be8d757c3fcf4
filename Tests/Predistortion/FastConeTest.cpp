// SPDX-License-Identifier: GPL-3.0-or-later
// The limit of the excursion where a cone is quick against the sample rate: tones whose period is a whole number of
// ticks, so that a decision that looks once a tick always sees the same phase of them.
#include "Predistortion/Drivers.h"

#include "Engine/Loudspeaker/ModelFile.h"
#include "Engine/Loudspeaker/Resonance.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Numerics/Parallel.h"
#include "Engine/Predistortion/Predistorter.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <thread>
#include <vector>

using namespace excursion;

namespace {

Model fastFactoryModel(const char* name) { return readModel(std::string("Presets/drivers/") + name + ".json"); }

/// A compression driver's diaphragm, Q 0.8: resonance in Hz, bending by a quarter within 0.2 mm.
Model quickDriver(double resonance)
{
    constexpr double m = 1e-4, Q = 0.8, range = 0.2e-3;
    const double w = 2.0 * std::numbers::pi * resonance;
    auto model = makeModel("electrodynamic");
    const double Re = 6.0, loss = w * m / Q;
    const std::pair<const char*, double> base[] {{"Re", Re}, {"Le", 2e-5},        {"Bl", std::sqrt(0.7 * loss * Re)},
                                                 {"m", m},   {"Rms", 0.3 * loss}, {"K", w * w * m}};
    for (const auto& [parameter, value] : base)
        model.baseParameter(parameter).value = value;
    for (const char* const id : {"force-factor", "stiffness"}) {
        OperatingRange visited;
        visited.displacement = range;
        visited.velocity = w * range;
        visited.current = 3.0;
        visited.lowFrequency = 50.0;
        visited.highFrequency = 8000.0;
        model = withEffect(model, effectNamed(id), visited);
        auto& added = model.components.back();
        added.parameters[0].value = 0.03 * added.operatingRange.scale;
        added.parameters[1].value = (id == std::string("stiffness") ? 0.2 : -0.15) * added.operatingRange.scale;
    }
    return model;
}

/// How far, in units of the limit, the simulated driver goes; infinite if there was a fault.
/// @param level  of the tone; 1 would take a linear driver to the limit
double reached(const Model& model, double rate, double frequency, double phase, double level, double seconds)
{
    const double limit = 0.8 * measuredDisplacement(model);
    const double volts = level * limit
                         / std::abs(
                             respond(linearPart(model), {Quantity::displacement}, {frequency}).front().value.front());
    std::vector<double> u(static_cast<std::size_t>(seconds * rate));
    for (std::size_t n = 0; n < u.size(); ++n) {
        const double t = static_cast<double>(n) / rate;
        u[n] = volts * std::min(1.0, t / 0.1) * std::sin(2.0 * std::numbers::pi * frequency * t + phase);
    }
    PredistortionControls controls;
    controls.displacementLimit = limit;
    Predistorter engine(model, {rate, 2}, controls);
    const auto out = through(engine, u);
    if (engine.collectMeters().faults > 0)
        return infinity;
    return peak(simulate(model, out, rate, {}).find(Quantity::displacement)->samples) / limit;
}

struct FastCone {
    std::string name;
    Model model;
};

/// Whether a tick, or a step of what is looked at, is long against a period: else nothing here differs from what the
/// studies of random drivers try.
bool quick(const Model& model, double rate) { return 16.0 * resonanceOf(model) > 0.03 * rate; }

/// @param frequencies  of the tones, in units of the resonance; each is replaced by the nearest fs/(16 k)
void checkTones(const std::vector<FastCone>& cones, const std::vector<double>& frequencies,
                const std::vector<double>& levels, double seconds)
{
    struct Tone {
        const FastCone* cone;
        double rate, frequency, phase, level, most;
    };
    std::vector<Tone> tones;
    for (const auto& cone : cones)
        for (const double rate : {8000.0, 11025.0, 22050.0, 48000.0}) {
            if (!quick(cone.model, rate))
                continue;
            std::set<int> ticks;
            for (const double f : frequencies)
                ticks.insert(std::max(1, static_cast<int>(std::lround(rate / (16.0 * f * resonanceOf(cone.model))))));
            for (const int k : ticks)
                for (const double phase : {0.0, 0.25 * std::numbers::pi})
                    for (const double level : levels)
                        tones.push_back({&cone, rate, rate / (16.0 * k), phase, level, 0.0});
        }
    inParallel(tones.size(), std::thread::hardware_concurrency(), {}, [&](std::size_t n) {
        auto& tone = tones[n];
        tone.most = reached(tone.cone->model, tone.rate, tone.frequency, tone.phase, tone.level, seconds);
        return true;
    });
    double worst = 0.0;
    for (const auto& tone : tones) {
        INFO(tone.cone->name << " (" << resonanceOf(tone.cone->model) << " Hz) at " << tone.rate << " Hz, "
                             << tone.frequency << " Hz, phase " << tone.phase << ", " << tone.level << " x the limit");
        CHECK(tone.most < 1.01);
        worst = std::max(worst, tone.most);
    }
    WARN("at most " << 100.0 * worst << " % of the excursion's limit");
    CHECK(worst > 0.9);  // not by doing nothing
}

}  // namespace

TEST_CASE("The excursion's limit holds for a cone that is quick against the sample rate", "[protection][slow]")
{
    checkTones({{"micro speaker", fastFactoryModel("micro-speaker")},
                {"quick driver", quickDriver(800.0)},
                {"quicker driver", quickDriver(1200.0)}},
               {0.5, 1.0, 2.0}, {1.06, 1.25, 3.0}, 0.5);
}

TEST_CASE("The excursion's limit holds at tones of whole ticks for every driver", "[.minutes][slow]")
{
    std::vector<FastCone> cones;
    for (const char* const name :
         {"full-range", "micro-speaker", "midbass-seed", "midrange", "pro-woofer", "subwoofer", "woofer"})
        cones.push_back({name, fastFactoryModel(name)});
    for (const double resonance : {800.0, 1000.0, 1200.0})
        cones.push_back({"quick driver", quickDriver(resonance)});
    checkTones(cones, {0.4, 0.7, 1.0, 1.5, 2.2, 3.0}, {1.02, 1.25, 3.0}, 0.6);
}
