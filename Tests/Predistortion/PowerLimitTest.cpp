// SPDX-License-Identifier: GPL-3.0-or-later
// The limit of the coil's power through a bypass, and when another engine takes over.
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

constexpr double heatRate = 48000.0, heatFullScale = 8.0;

ChainControls cooled(double powerLimit)
{
    ChainControls controls {Mode::linearize, heatFullScale, 1.0, {}};
    controls.predistortion.powerLimit = powerLimit;
    return controls;
}

/// W, the largest mean over a second of the heat in the coil of a driver that is given these samples.
double warmest(const Model& model, std::vector<double> samples)
{
    for (auto& sample : samples)
        sample *= heatFullScale;
    const auto take = simulate(model, samples, heatRate, {});
    const double share = 1.0 - std::exp(-1.0 / (heatRate * PredistortionControls::averagingTime));
    double mean = 0.0, most = 0.0;
    for (const double i : take.find(Quantity::current)->samples) {
        mean += share * (model.baseParameter("Re").value * i * i - mean);
        most = std::max(most, mean);
    }
    return most;
}

/// A tone of twenty times the heat.
struct Loud {
    Model model = midbass();
    std::vector<double> samples;
    double limit = 0.0;
    explicit Loud(double seconds)
    {
        for (std::size_t n = 0; n < static_cast<std::size_t>(seconds * heatRate); ++n)
            samples.push_back(std::sin(2.0 * std::numbers::pi * 200.0 * static_cast<double>(n) / heatRate));
        limit = warmest(model, {samples.begin(), samples.begin() + 24000}) / (1.0 - std::exp(-0.5)) / 20.0;
    }
};

}  // namespace

TEST_CASE("A coil is as warm after a bypass as it was, but for the time between", "[chain][protection]")
{
    const Loud loud(6.0);
    auto controls = cooled(loud.limit);
    Chain chain(loud.model, {heatRate, 2}, controls);
    auto u = loud.samples;
    constexpr std::size_t block = 480, off = 300 * block, on = 306 * block,  // for 60 ms
        heard = 314 * block;  // the plain signal has faded, whose heat no limit counts
    for (std::size_t n = 0; n < u.size(); n += block) {
        controls.mode = n >= off && n < on ? Mode::bypass : Mode::linearize;
        if (n >= off && n < heard)
            std::fill_n(u.begin() + static_cast<std::ptrdiff_t>(n), block, 0.0);
        chain.set(controls);
        chain.process(u.data() + n, u.data() + n, block);
    }
    const double heat = warmest(loud.model, u);
    INFO(heat << " W of " << loud.limit);
    CHECK(heat < 1.01 * loud.limit);
    CHECK(heat > 0.88 * loud.limit);  // a tone stays at 0.9 of it
    // Longer, and it is cold: as at first, there is room for a while.
    controls.mode = Mode::bypass;
    chain.set(controls);
    std::vector<double> silence(static_cast<std::size_t>(8.0 * heatRate));
    chain.process(silence.data(), silence.data(), silence.size());
    controls.mode = Mode::linearize;
    chain.set(controls);
    auto again = loud.samples;
    chain.process(again.data(), again.data(), again.size());
    const auto first = std::vector<double>(again.begin(), again.begin() + 4800),
               last = std::vector<double>(again.end() - 4800, again.end());
    CHECK(rms(first) > 1.5 * rms(last));
}

TEST_CASE("A coil is as warm when another engine takes over as it was", "[chain][protection]")
{
    const Loud loud(6.0);
    const auto controls = cooled(loud.limit);
    const auto make = [&] { return std::make_unique<Chain>(loud.model, RealTimeOptions {heatRate, 2}, controls); };
    Crossfade<Chain> crossfade(2400, 2400);
    crossfade.start(make());
    auto u = loud.samples;
    for (std::size_t n = 0; n < u.size(); n += 480) {
        if (n == 300 * 480)
            crossfade.offer(make());
        crossfade.process(u.data() + n, u.data() + n, 480);
    }
    crossfade.collect();
    const double heat = warmest(loud.model, u);
    INFO(heat << " W of " << loud.limit);
    CHECK(heat < 1.01 * loud.limit);
}
