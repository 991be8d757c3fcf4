// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/Portrait.h"
#include "Loudspeaker/EffectBench.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace excursion;

namespace {

/// A driver with this effect at work, with these values, and its other shapes as they are usual.
Model driverWith(const char* effect, const std::vector<double>& values)
{
    auto model = withEffect(makeModel("electrodynamic"), effectNamed(effect), someOperatingRange(1.0));
    REQUIRE(values.size() <= model.components.back().parameters.size());
    for (std::size_t k = 0; k < values.size(); ++k)
        model.components.back().parameters[k].value = values[k];
    followOthers(model);
    return model;
}

/// The model with this standard error of one parameter of its effect; all others are known.
Model unsure(Model model, std::size_t parameter, double error)
{
    const auto all = static_cast<Eigen::Index>(parametersOf(model).size());
    const auto at = static_cast<Eigen::Index>(model.components.front().parameters.size() + parameter);
    model.covariance = Eigen::MatrixXd::Zero(all, all);
    model.covariance(at, at) = error * error;
    return model;
}

Portrait only(const Model& model)
{
    const auto all = portraits(model);
    REQUIRE(all.size() == 1);
    CHECK(all.front().effectId == model.components.back().effect->id());
    return all.front();
}

}  // namespace

TEST_CASE("Dahl's hysteresis is drawn as the loops of its closed form", "[portrait]")
{
    const double Fc = 0.3, r = 5e-4;
    const auto portrait = only(driverWith("friction", {Fc, r, 0.0, 0.0, 0.0}));
    CHECK((portrait.unit == "N" && portrait.argumentUnit == "m"));
    REQUIRE(portrait.lines.size() == 3);
    for (const auto& line : portrait.lines) {
        const double A = line.size, turned = std::tanh(A / r);  // of Fc, where it turns
        double wrong = 0.0, area = 0.0;
        const std::size_t quarter = (line.argument.size() - 1) / 4;
        for (std::size_t n = 0; n < line.argument.size(); ++n) {
            const bool down = n >= quarter && n < 3 * quarter;
            const double gone = down ? A - line.argument[n] : A + line.argument[n];
            const double force = Fc * (1.0 - (1.0 + turned) * std::exp(-gone / r));
            wrong = std::max(wrong, std::abs(line.value[n] - (down ? -force : force)));
            if (n > 0)
                area += 0.5 * (line.value[n] + line.value[n - 1]) * (line.argument[n] - line.argument[n - 1]);
        }
        INFO("to " << A);
        CHECK(wrong < 2e-3 * Fc);
        // lost in a period: 4 Fc A less what a spring of Fc/r gives back
        CHECK(area == Approx(4.0 * Fc * (A - r * turned)).epsilon(0.01));
    }
    CHECK(portrait.lines[0].size == someOperatingRange(1.0).displacement);
    CHECK(portrait.lines[2].size == 0.25 * portrait.lines[0].size);
}

TEST_CASE("Heating is drawn as the resistance at a steady current", "[portrait]")
{
    const auto range = someOperatingRange(1.0);
    const double rise = 0.05, fast = 0.2 * range.duration;
    const auto model = driverWith("coil-heating", {rise, std::log10(fast), 0.0, std::log10(range.duration)});
    const double Re = model.baseParameter("Re").value;
    const auto portrait = only(model);
    REQUIRE(portrait.lines.size() == 1);
    CHECK((portrait.name == "Re" && portrait.unit == "ohm" && portrait.argumentUnit == "s"));
    const auto& line = portrait.lines.front();
    const double fed = rise * line.size * line.size;  // what is hot draws more power at the same current
    REQUIRE(fed < 1.0);
    for (std::size_t n = 0; n < line.argument.size(); ++n)
        REQUIRE(line.value[n]
                == Approx(Re + Re * fed / (1.0 - fed) * (1.0 - std::exp(-line.argument[n] * (1.0 - fed) / fast)))
                       .epsilon(1e-6));
    CHECK(line.argument.back() == Approx(range.duration));
}

TEST_CASE("Doppler is drawn as the lateness of the sound, with a band as wide as its standard error", "[portrait]")
{
    const double c = 343.0, relative = 0.02;
    const auto portrait = only(unsure(driverWith("doppler", {1.0 / c}), 0, relative / c));
    const auto& line = portrait.lines.front();
    REQUIRE(line.argument.front() == -line.argument.back());
    for (std::size_t n = 0; n < line.argument.size(); ++n) {
        REQUIRE(line.value[n] == Approx(-line.argument[n] / c).margin(1e-15));
        REQUIRE(line.halfWidth[n] == Approx(1.96 * relative * std::abs(line.argument[n]) / c).margin(1e-12));
    }
}

TEST_CASE("A loop's band grows with what its limit leaves open", "[portrait]")
{
    const auto model = driverWith("friction", {0.3, 5e-4, 2.0, 0.2, 0.1});
    CHECK(std::isnan(only(model).lines.front().halfWidth.front()));  // no covariance, no band
    const auto line = only(unsure(model, 0, 0.03)).lines.front();  // a tenth of Fc, to which the force is in proportion
    for (std::size_t n = 0; n < line.value.size(); ++n)
        REQUIRE(line.halfWidth[n] == Approx(1.96 * 0.1 * std::abs(line.value[n])).margin(1e-9));
}

TEST_CASE("Every effect has something to show", "[portrait]")
{
    for (const auto* effect : catalogue()) {
        INFO(effect->id());
        const auto evidence = effect->evidence();
        CHECK((evidence == Evidence::law) == effect->law().has_value());
        CHECK((evidence == Evidence::response) == effect->linear());
        auto model = withEffect(makeModel("electrodynamic"), *effect, someOperatingRange(1.0));
        const bool own = evidence != Evidence::law && evidence != Evidence::response;
        CHECK(portraits(model).size() == (own ? 1 : 0));
    }
}

TEST_CASE("A hysteresis that slips at once has loops that close at its limit", "[portrait]")
{
    const double Fc = 0.3, X = someOperatingRange(1.0).displacement;
    const auto portrait = only(driverWith("friction", {Fc, 2e-3 * X, 2.0, 0.5, 0.1}));
    for (const auto& line : portrait.lines) {
        INFO("to " << line.size);
        CHECK(std::abs(line.value.front() - line.value.back()) < 1e-3 * Fc);
        for (const double force : line.value)
            REQUIRE(std::abs(force) < 1.001 * Fc);
        CHECK(line.value.front() == Approx(Fc).epsilon(1e-3));  // at rest, moving outward
    }
}
