// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Datasheet/Impedances.h"
#include "Engine/Datasheet/LossyInductance.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/Catalogue.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace excursion;

namespace {

/// A coil in iron, K s^a, beside almost no Le.
Model inIron(double K, double a, double Le = 1e-9)
{
    auto model = makeModel("electrodynamic");
    model.baseParameter("Le").value = Le;
    const OperatingRange operatingRange {
        .displacement = 2e-3, .velocity = 0.5, .current = 2.0, .lowFrequency = 20.0, .highFrequency = 10000.0};
    model = withEffect(std::move(model), effectNamed("eddy-currents"), operatingRange);
    model.components.back().parameters[0].value = K;
    model.components.back().parameters[1].value = a;
    return model;
}

const LossyForm& formNamed(const LossyInductance& inductance, const std::string& id)
{
    for (const auto& form : inductance.forms)
        if (form.id == id)
            return form;
    throw std::out_of_range(id);
}

double parameter(const LossyForm& form, const std::string& name)
{
    for (const auto& p : form.parameters)
        if (p.name == name)
            return p.value;
    throw std::out_of_range(name);
}

}  // namespace

TEST_CASE("A semi-inductance is found where there is one", "[datasheet]")
{
    const auto found = lossyInductance(inIron(0.012, 0.68));
    CHECK_FALSE(found.lossless);
    CHECK(found.low >= 20.0);
    CHECK(found.high == 10000.0);
    const auto& leach = formNamed(found, "semi-inductance");
    CHECK(parameter(leach, "K") == Approx(0.012).epsilon(5e-3));
    CHECK(parameter(leach, "n") == Approx(0.68).epsilon(1e-3));
    CHECK(leach.errorPercent < 0.05);
    const auto& wright = formNamed(found, "wright");
    CHECK(parameter(wright, "Er") == Approx(0.68).epsilon(5e-3));
    CHECK(parameter(wright, "Kx") / parameter(wright, "Kr") == Approx(std::tan(0.34 * std::numbers::pi)).epsilon(0.05));
    CHECK(wright.errorPercent <= leach.errorPercent * 1.0001);
    const auto &lr2 = formNamed(found, "lr2"), &lr3 = formNamed(found, "lr3");
    CHECK(lr3.errorPercent < 0.5 * lr2.errorPercent);
    CHECK(lr3.errorPercent < 2.5);

    // At a = 1/2 the semi-inductor of Thorborg and Futtrup is the whole of it.
    const auto root = lossyInductance(inIron(0.05, 0.5));
    const auto& thorborg = formNamed(root, "thorborg-futtrup");
    CHECK(thorborg.errorPercent < 0.1);
    CHECK(parameter(thorborg, "Ke") == Approx(0.05).epsilon(0.02));
}

TEST_CASE("The errors that are told are those of the forms", "[datasheet]")
{
    const auto model = inIron(0.012, 0.68, 1e-4);
    const auto found = lossyInductance(model, 200.0, 8000.0);
    CHECK(found.low == 200.0);
    CHECK(found.high == 8000.0);
    for (const auto& form : found.forms) {
        double sum = 0.0, worst = 0.0;
        int count = 0;
        for (double f = 200.0; f < 8000.0; f *= std::exp2(1.0 / 96.0), ++count) {
            const auto Z = blockedImpedance(model, {f}).front(),
                       fitted = found.Re + impedanceOf(form, 2.0 * std::numbers::pi * f);
            sum += std::norm((fitted - Z) / Z);
            worst = std::max(worst, std::abs(20.0 * std::log10(std::abs(fitted / Z))));
        }
        INFO(form.id);
        CHECK(100.0 * std::sqrt(sum / count) == Approx(form.errorPercent).epsilon(0.05));
        CHECK(worst == Approx(form.worstDb).epsilon(0.1).margin(1e-4));
    }
}

TEST_CASE("The forms are what other programs reckon with", "[datasheet]")
{
    const double w = 2.0 * std::numbers::pi * 1000.0;
    const std::complex<double> j(0.0, 1.0);
    const LossyForm lr3 {
        "lr3", "", {{"Le", "H", 1e-4}, {"L2", "H", 5e-4}, {"R2", "ohm", 3.0}, {"L3", "H", 2e-4}, {"R3", "ohm", 9.0}}};
    CHECK(
        std::abs(impedanceOf(lr3, w)
                 - (j * w * 1e-4 + 1.0 / (1.0 / (j * w * 5e-4) + 1.0 / 3.0) + 1.0 / (1.0 / (j * w * 2e-4) + 1.0 / 9.0)))
        < 1e-12);
    const LossyForm leach {"semi-inductance", "", {{"K", "", 0.02}, {"n", "", 0.7}}};
    CHECK(std::abs(impedanceOf(leach, w) - 0.02 * std::pow(j * w, 0.7)) < 1e-12);
    const LossyForm thorborg {
        "thorborg-futtrup", "", {{"Leb", "H", 5e-5}, {"Le", "H", 1e-3}, {"Ke", "", 0.06}, {"Rss", "ohm", 50.0}}};
    CHECK(std::abs(impedanceOf(thorborg, w)
                   - (j * w * 5e-5 + 1.0 / (1.0 / (j * w * 1e-3) + 1.0 / (0.06 * std::sqrt(j * w)) + 1.0 / 50.0)))
          < 1e-12);
}

TEST_CASE("A plain inductance, a band that is none and a driver without a coil", "[datasheet]")
{
    const auto plain = lossyInductance(makeModel("electrodynamic"));
    CHECK(plain.lossless);
    CHECK(plain.Le == 3e-4);
    CHECK(plain.forms.empty());
    CHECK_THROWS_AS(lossyInductance(inIron(0.01, 0.7), 1000.0, 1500.0), Error);
    CHECK_THROWS_AS(lossyInductance(inIron(0.01, 0.7), 2000.0, 1000.0), Error);
    CHECK_THROWS_AS(lossyInductance(makeModel("mechanical")), Error);
}
