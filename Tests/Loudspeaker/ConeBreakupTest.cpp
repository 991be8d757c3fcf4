// SPDX-License-Identifier: GPL-3.0-or-later
// Modes of the cone, found in frequency responses.
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FitResponse.h"
#include "Engine/Loudspeaker/SmallSignal.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

using namespace excursion;

namespace {

struct Mode {
    double frequency, quality, gain;  // Hz, 1, change of the pressure at the resonance
};

Model midbass()
{
    auto model = makeModel("electrodynamic");
    model.path.parameters[1].value = 1.0 / 343.0;
    for (auto& p : model.path.parameters)
        p.free = true;
    return model;
}

/// Current, displacement and pressure with modes and noise of that share.
std::vector<ResponseTarget> measured(const std::vector<Mode>& modes, double noise, unsigned seed)
{
    constexpr double pointsPerOctave = 48.0, low = 20.0, high = 10000.0;
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0.0, noise / std::numbers::sqrt2);
    std::vector<ResponseTarget> targets;
    for (const auto quantity : {Quantity::current, Quantity::displacement, Quantity::pressure}) {
        ResponseTarget target;
        target.quantity = quantity;
        for (double f = low; f <= high; f *= std::exp2(1.0 / pointsPerOctave))
            target.frequency.push_back(f);
        target.value = respond(midbass(), {quantity}, target.frequency).front().value;
        for (std::size_t k = 0; k < target.value.size(); ++k) {
            const double f = target.frequency[k];
            std::complex<double> factor = 1.0;
            if (quantity == Quantity::pressure)
                for (const auto& mode : modes)
                    factor += mode.gain / mode.quality * f * f
                              / std::complex<double>(mode.frequency * mode.frequency - f * f,
                                                     f * mode.frequency / mode.quality);
            target.deviation.push_back(noise * std::abs(target.value[k]));
            target.value[k] *= factor + std::complex<double>(normal(random), normal(random));
        }
        targets.push_back(std::move(target));
    }
    return targets;
}

/// Mean square of what is left, in deviations: 1 when that is the noise.
double left(const Model& model, const std::vector<ResponseTarget>& targets)
{
    double sum = 0.0, count = 0.0;
    for (const auto& target : targets) {
        const auto value = respond(model, {target.quantity}, target.frequency).front().value;
        for (std::size_t k = 0; k < value.size(); ++k)
            sum += std::norm((value[k] - target.value[k]) / target.deviation[k]);
        count += static_cast<double>(value.size());
    }
    return sum / count;
}

/// The base fitted as if there were no modes, and they on top of it.
Model found(const std::vector<ResponseTarget>& targets)
{
    auto model = midbass();
    model.path.parameters[1].value *= 1.01;
    REQUIRE(fitResponse(model, targets, {60, 1e-8}).usable());
    REQUIRE(addByResponse(model, effectNamed("cone-breakup"), targets).usable());
    return model;
}

}  // namespace

TEST_CASE("Narrow modes of the cone are found in the responses, wherever they lie", "[breakup]")
{
    const std::vector<std::vector<Mode>> cones {
        {{6100.0, 30.0, 0.5}},
        {{2300.0, 12.0, -0.15}, {7700.0, 40.0, 0.6}},
        {{4000.0, 15.0, 0.4}, {4400.0, 20.0, -0.3}},
        {{3100.0, 10.0, 0.3}, {5200.0, 25.0, -0.5}, {6900.0, 15.0, 0.2}, {9200.0, 35.0, 0.6}},
    };
    for (std::size_t k = 0; k < cones.size(); ++k) {
        CAPTURE(k);
        const auto targets = measured(cones[k], 0.003, static_cast<unsigned>(k));
        const auto model = found(targets);
        CHECK(left(model, targets) < 1.1);
        CHECK(isSeen(model, 1));
    }
}

TEST_CASE("No mode is found where there is none", "[breakup]")
{
    const auto targets = measured({}, 0.01, 5);
    const auto model = found(targets);
    for (const auto& p : model.components.back().parameters)
        CHECK((!p.strength || p.value == 0.0));
    CHECK_FALSE(isSeen(model, 1));
}

TEST_CASE("Random modes of the cone come out at the noise", "[.study]")
{
    std::mt19937 random(1);
    const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
    constexpr unsigned cones = 60;
    for (unsigned n = 0; n < cones; ++n) {
        std::vector<Mode> modes(1 + static_cast<std::size_t>(uniform(0.0, 3.9999)));
        for (auto& mode : modes) {
            mode.frequency = 10000.0 * std::exp2(uniform(-2.2, -0.05));
            mode.quality = 4.0 * std::exp2(uniform(0.0, 3.3));
            mode.gain = std::copysign(0.05 * std::exp2(uniform(0.0, 3.6)), uniform(-1.0, 1.0));
        }
        const auto targets = measured(modes, n % 2 == 0 ? 0.01 : 0.003, n);
        CAPTURE(n);
        CHECK(left(found(targets), targets) < 1.1);
    }
}

TEST_CASE("A gain of a mode that the take hardly tells makes no cone implausible", "[breakup]")
{
    auto model = found(measured({{6100.0, 30.0, 0.5}}, 0.003, 1));
    REQUIRE(isPlausible(model, 1));
    auto& own = model.components[1].parameters;
    const auto mode = std::find_if(own.begin(), own.end(),
                                   [](const Parameter& p) { return p.name[0] == 'g' && p.value != 0.0; });
    REQUIRE(mode != own.end());
    auto& atSpot = *(mode + 1);
    REQUIRE(atSpot.name[0] == 'h');
    atSpot.value = 3.2;
    for (const auto& [error, plausible] : {std::pair {0.05, false}, {0.5, true}, {NAN, false}}) {
        INFO(error);
        atSpot.standardError = error;
        CHECK(isPlausible(model, 1) == plausible);
    }
    atSpot.value = 30.0;
    atSpot.standardError = 20.0;
    CHECK_FALSE(isPlausible(model, 1));
}
