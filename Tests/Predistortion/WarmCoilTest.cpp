// SPDX-License-Identifier: GPL-3.0-or-later
// What an engine must keep, and what it must forget, when it is switched.
#include "Predistortion/Drivers.h"

#include "Engine/Predistortion/Chain.h"

#include <catch2/catch.hpp>

#include <cmath>
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
