// SPDX-License-Identifier: GPL-3.0-or-later
#include "Linearization/Drivers.h"

#include "Engine/Error.h"
#include "Engine/Linearization/Chain.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace excursion;

namespace {

ChainControls controls(Mode mode) { return {mode, 8.0, 1.0, {}}; }

std::vector<double> played(Mode mode, const std::vector<double>& u)
{
    Chain chain(everything(), {48000.0, 2}, controls(mode));
    return through(chain, u);
}

std::vector<double> scaled(std::vector<double> values, double factor)
{
    for (auto& value : values)
        value *= factor;
    return values;
}

} // namespace

TEST_CASE("A chain does what its mode says, always as late", "[chain]")
{
    const auto u = burst(48000.0, 0.3, 1.0);
    const RealTimeOptions options {48000.0, 2};
    const auto model = everything();
    CHECK(played(Mode::bypass, u) == u);

    Predistorter bend(model, options);
    const auto bent = through(bend, scaled(u, 8.0));
    CHECK(relativeError(played(Mode::linearize, u), scaled(bent, 1.0 / 8.0)) < 1e-12);

    Speaker speaker(model, options);
    const double gain = 1.0 / (8.0 * plateau(model));
    CHECK(relativeError(played(Mode::speaker, u), scaled(through(speaker, scaled(u, 8.0)), gain)) < 1e-12);
    speaker.reset();
    auto both = played(Mode::audition, u), apart = scaled(through(speaker, bent), gain);
    both.resize(both.size() - 200);   // `bent` ends where the signal does, and the second filter looks beyond that
    apart.resize(both.size());
    CHECK(relativeError(both, apart) < 1e-6);   // the chain stays at the higher rate in between; a filter is flat within 3e-6

    // Linearized, the speaker is a linear one; alone it is not.
    Speaker straight(linearPart(model), options);
    const auto linear = scaled(through(straight, scaled(u, 8.0)), gain);
    CHECK(relativeError(played(Mode::audition, u), linear) < 1e-4);
    CHECK(relativeError(played(Mode::speaker, u), linear) > 0.01);
    auto sum = played(Mode::distortion, u);
    for (std::size_t n = 0; n < sum.size(); ++n)
        sum[n] += linear[n];
    CHECK(relativeError(sum, played(Mode::speaker, u)) < 1e-4);
}

TEST_CASE("No mode lets through what is not finite", "[chain]")
{
    for (const auto mode : modes) {
        INFO(name(mode));
        Chain chain(everything(), {48000.0, 2}, controls(mode));
        auto u = burst(48000.0, 0.3, 0.5);
        u[5000] = std::numeric_limits<double>::quiet_NaN();
        u[5001] = -std::numeric_limits<double>::infinity();
        const auto out = through(chain, u);
        CHECK(std::all_of(out.begin(), out.end(), [](double value) { return std::isfinite(value); }));
        CHECK(chain.take().faults == 2);
    }
}

TEST_CASE("Modes and levels are changed without a click", "[chain]")
{
    Chain chain(everything(), {48000.0, 2}, controls(Mode::bypass));
    std::vector<double> u(60000);
    for (std::size_t n = 0; n < u.size(); ++n)
        u[n] = 0.5 * std::sin(2.0 * std::numbers::pi * 150.0 * static_cast<double>(n) / 48000.0);
    auto out = u;
    std::size_t turn = 0;
    for (std::size_t n = 0; n < u.size(); n += 1000) {
        auto next = controls(modes[turn++ % modes.size()]);
        next.fullScale = turn % 2 == 0 ? 3.0 : 8.0;
        chain.set(next);
        chain.process(u.data() + n, out.data() + n, 1000);
    }
    double steepest = 0.0;
    for (std::size_t n = 1; n < out.size(); ++n)
        steepest = std::max(steepest, std::abs(out[n] - out[n - 1]));
    CHECK(steepest < 0.05);   // the tone has 0.01
}

TEST_CASE("A recipe is refused by field when it makes no sense", "[chain]")
{
    auto document = nlohmann::json::parse(toJson(Recipe {}).dump());
    const auto refused = [&](const char* key, const nlohmann::json& value) {
        auto broken = document;
        broken[key] = value;
        try {
            recipeFromJson(JsonField(broken, "", "r.json"));
            FAIL("not refused: " << key);
        } catch (const Error& error) {
            CHECK(std::string(error.what()).find(key) != std::string::npos);
        }
    };
    CHECK_NOTHROW(recipeFromJson(JsonField(document, "", "r.json")));
    refused("mode", "loud");
    refused("amount", 2);
    refused("fullScale", 0);
    refused("displacementLimit", "far");
    refused("voltageLimit", -1);
    refused("trimDb", 100);
    refused("off", nlohmann::json::array({"warp-drive"}));
    refused("version", 2);
}

TEST_CASE("Effects that a recipe switches off are not in the model that is run", "[chain]")
{
    Recipe recipe;
    recipe.off = {"creep", "stiffness"};
    const auto model = withoutOff(withoutEffect(everything(), "creep"), recipe);
    CHECK(model.effectIds().size() == everything().effectIds().size() - 2);
    CHECK_FALSE(model.has("stiffness"));
}
