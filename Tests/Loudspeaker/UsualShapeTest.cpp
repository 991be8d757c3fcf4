// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FitResponse.h"
#include "Engine/Loudspeaker/SmallSignal.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

using namespace excursion;

namespace {

constexpr double low = 8.0, high = 15e3;

Model woofer(double Le)
{
    auto model = makeModel("electrodynamic");
    const double values[] = {4.0, Le, 12.6, 26e-3, 2.7, 1490.0};
    for (std::size_t k = 0; k < 6; ++k)
        model.components.front().parameters[k].value = values[k];
    return model;
}

/// Current and displacement of the woofer whose coil has another impedance besides s Le, in closed form.
std::vector<ResponseTarget> measured(double Le,
                                     const std::function<std::complex<double>(std::complex<double>)>& besides)
{
    std::vector<ResponseTarget> targets {{Quantity::current, false, {}, {}, {}},
                                         {Quantity::displacement, false, {}, {}, {}}};
    for (double f = low; f < high; f *= std::exp2(1.0 / 12.0)) {
        const std::complex<double> s(0.0, 2.0 * std::numbers::pi * f);
        const auto alone = respond(woofer(Le), {Quantity::current, Quantity::displacement}, {f}, false);
        const auto current = 1.0 / (1.0 / alone[0].value.front() + besides(s));
        const std::complex<double> values[] {current, alone[1].value.front() * current / alone[0].value.front()};
        for (std::size_t n = 0; n < 2; ++n) {
            targets[n].frequency.push_back(f);
            targets[n].value.push_back(values[n]);
            targets[n].deviation.push_back(1e-4 * std::abs(values[n]));
        }
    }
    return targets;
}

/// Z = s Le + K s^a
std::vector<ResponseTarget> measured(double Le, double K, double a)
{
    return measured(Le, [=](std::complex<double> s) { return K * std::pow(s, a); });
}

double exponentOf(const Model& model) { return model.components[1].parameters[1].value; }

}  // namespace

TEST_CASE("Eddy currents that have left their law are found in its shape again", "[eddy-currents]")
{
    constexpr double Le = 0.693e-3, K = 1.47e-3, a = 0.718;
    const auto targets = measured(Le, K, a);
    OperatingRange range;
    range.lowFrequency = low;
    range.highFrequency = high;
    auto model = withEffect(woofer(Le / 3.0), effectNamed("eddy-currents"), range);
    auto& own = model.components.back().parameters;
    own[0].value = 7.2e-4;
    own[1].value = 0.973;
    const double departed[] = {-2.8, -1.37, -3.57, -0.82, -1.36, 0.135, -0.268, 0.445, 0.931, 0.363};
    for (std::size_t k = 0; k < 10; ++k)
        own[2 + k].value = departed[k];
    CHECK(hasUnusualShape(model.components[1]));
    REQUIRE(responseErrorDb(model, targets) > -40.0);
    REQUIRE(fitUsualShape(model, 1, targets).usable());
    CHECK(exponentOf(model) == Approx(a).epsilon(0.01));
    CHECK(model.baseParameter("Le").value == Approx(Le).epsilon(0.01));
    CHECK_FALSE(hasUnusualShape(model.components[1]));
    CHECK(responseErrorDb(model, targets) < -70.0);
}

TEST_CASE("A coil with one loop beside it, far from any power of frequency, is followed to -70 dB over three decades",
          "[eddy-currents]")
{
    // R2 || L2, as the impedance of drivers is often drawn
    constexpr double Le = 0.35e-3, L2 = 0.33e-3;
    for (const double corner : {150.0, 1360.0, 6000.0}) {
        const double R2 = 2.0 * std::numbers::pi * corner * L2;
        const auto targets = measured(Le, [&](std::complex<double> s) { return s * L2 * R2 / (R2 + s * L2); });
        auto model = woofer(Le + L2);
        REQUIRE(addByResponse(model, effectNamed("eddy-currents"), targets).usable());
        const auto made = respond(model, {Quantity::current}, targets[0].frequency).front();
        double error = 0.0;
        for (std::size_t k = 0; k < made.value.size(); ++k)
            error += std::norm(made.value[k] / targets[0].value[k] - 1.0) / static_cast<double>(made.value.size());
        INFO(corner << " Hz: " << 10.0 * std::log10(error) << " dB");
        CHECK(10.0 * std::log10(error) < -70.0);
    }
}
