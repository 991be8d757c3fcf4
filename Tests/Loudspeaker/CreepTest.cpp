// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FitResponse.h"
#include "Engine/Loudspeaker/ModelFile.h"
#include "Engine/Loudspeaker/SmallSignal.h"

#include <catch2/catch.hpp>

#include <numbers>
#include <random>

using namespace excursion;

namespace {

constexpr double K = 1600.0, low = 10.0, high = 2000.0;

Model woofer()
{
    auto model = makeModel("electrodynamic");
    const double values[] = {5.6, 0.9e-3, 9.4, 51e-3, 0.6, K};
    for (std::size_t k = 0; k < 6; ++k)
        model.components.front().parameters[k].value = values[k];
    return model;
}

double strengthOf(const Model& model) { return model.components.back().parameters.front().value; }

/// Displacement and current of the woofer with the logarithmic creep of Knudsen and Jensen,
///     K(f) = K (1 + share (log10(f/low) + i pi/(2 ln 10))),
/// which is that of no finite chain, with a relative error.
std::vector<ResponseTarget> creeping(double share, double error, unsigned seed)
{
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::vector<ResponseTarget> targets;
    for (const auto quantity : {Quantity::displacement, Quantity::current}) {
        ResponseTarget target;
        target.quantity = quantity;
        for (double f = low; f < high; f *= std::exp2(1.0 / 12.0)) {
            auto there = woofer();
            there.baseParameter("K").value *= 1.0 + share * std::log10(f / low);
            there.baseParameter("Rms").value += share * K * std::numbers::pi / (2.0 * std::numbers::ln10)
                                                / (2.0 * std::numbers::pi * f);
            const auto value = respond(there, {quantity}, {f}, false).front().value.front();
            target.frequency.push_back(f);
            target.value.push_back(value * (1.0 + error * std::complex<double>(normal(random), normal(random))));
            target.deviation.push_back(error * std::abs(value));
        }
        targets.push_back(std::move(target));
    }
    return targets;
}

}  // namespace

TEST_CASE("What is plausible of creep beforehand follows the stiffness, whoever of the two has it", "[creep]")
{
    OperatingRange range;
    range.lowFrequency = low;
    auto model = withEffect(woofer(), effectNamed("creep"), range);
    const auto& S = model.components.back().parameters.front();
    CHECK(S.prior == Approx(0.3 * K));
    model.baseParameter("K").value = 3.0 * K;
    followOthers(model);
    CHECK(S.prior == Approx(0.9 * K));
    auto& own = model.components.back().parameters;
    own[0].value = 2.0 * K;
    own[1].value = std::log10(low) - 1.9;  // far below the band: stiffness there
    own[2].value = 0.0;
    model.baseParameter("K").value = K;
    followOthers(model);
    CHECK(S.prior == Approx(0.9 * K).epsilon(0.01));
    CHECK(isItself(model, 1));
    own[1].value = std::log10(low) + 1.4;  // above it, air that leaks
    followOthers(model);
    CHECK(S.prior == Approx(0.3 * K).epsilon(0.01));
    own[0].value = 2.1 * K;
    CHECK_FALSE(isItself(model, 1));
}

TEST_CASE("A file that does not tell the scale of creep says as much of it beforehand", "[creep]")
{
    auto model = withEffect(woofer(), effectNamed("creep"), {});
    auto document = toJson(model);
    document["effects"][0]["operatingRange"]["scale"] = 1.0;
    const auto read = modelFromJson(document, "old.json");
    CHECK(read.components.back().parameters.front().prior == Approx(0.3 * K));
    CHECK(read.components.back().operatingRange.scale == 1.0);
}

TEST_CASE("Logarithmic creep is creep, however much of the stiffness it takes", "[creep]")
{
    const double share = GENERATE(0.1, 0.3);
    for (const double error : {1e-3, 3e-3, 1e-2}) {
        auto model = woofer();
        REQUIRE(addByResponse(model, effectNamed("creep"), creeping(share, error, 1)).usable());
        INFO(share << " a decade, error " << error << ", S = " << strengthOf(model));
        CHECK(isItself(model, 1));
        CHECK(strengthOf(model) > share * K);
        const auto& creep = model.components.back();
        const auto stiffness = [&](double f) {
            return model.baseParameter("K").value
                   + creep.effect->addsTo("K", creep.operatingRange, valuesOf(creep).data(), f);
        };
        for (const double f : {low, 3.0 * low, 10.0 * low})
            CHECK(stiffness(f) == Approx(K * (1.0 + share * std::log10(f / low))).epsilon(0.05 + 2.0 * error));
    }
}
