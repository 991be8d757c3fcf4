// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/FitEffects.h"
#include "Engine/Estimate/MakeRecord.h"
#include "SmallSetup.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

using namespace excursion;

namespace {

std::map<std::string, ResidualCurve> againstTime(const Comparison& comparison)
{
    std::map<std::string, ResidualCurve> curves;
    for (const auto& curve : comparison.overTime)
        curves[curve.residual] = curve;
    return curves;
}

}  // namespace

TEST_CASE("Against the time a model lacks the resistance and the stiffness by which its driver drifted", "[compare]")
{
    auto setup = smallSetup();
    setup.excitation.realizations = 3;
    setup.excitation.levels = {1.0, 2.0};
    auto record = makeRecord(bench::measure(bench::Loudspeaker {}, setup));
    const auto model = fitEffects(record, {}, {});
    OutputErrorOptions options;
    options.gradient = false;
    options.spectra = true;
    const auto driftAt = [](double time) { return 0.1 * time; };  // a second
    for (std::size_t n = 0; n < record.sections.size(); ++n) {
        auto drifted = model;
        drifted.baseParameter("Re").value *= 1.0 + driftAt(record.sections[n].middle);
        drifted.baseParameter("K").value *= 1.0 - driftAt(record.sections[n].middle);
        const auto fit = outputError(drifted, record, {n}, {}, options).front();
        REQUIRE(fit.finite);
        record.sections[n].measured = fit.predicted;
    }
    const auto curves = againstTime(compare(model, record));
    REQUIRE(curves.size() == 2);
    const auto& resistance = curves.at("resistance");
    const auto& stiffness = curves.at("stiffness");
    REQUIRE(resistance.argument.size() == record.sections.size());
    CHECK(std::is_sorted(resistance.argument.begin(), resistance.argument.end()));
    const double Re = model.baseParameter("Re").value, K = model.baseParameter("K").value;
    for (std::size_t n = 0; n < resistance.argument.size(); ++n) {
        const double drift = driftAt(resistance.argument[n]);
        CHECK(resistance.mean[n] == Approx(Re * drift).epsilon(0.01));
        CHECK(stiffness.mean[n] == Approx(-K * drift).epsilon(0.01));
        CHECK(stiffness.scatter[n] < 0.05 * K * drift);
    }
}

TEST_CASE("A loudspeaker that does not drift lacks neither resistance nor stiffness", "[compare]")
{
    auto setup = smallSetup();
    constexpr int sections = 8;
    setup.excitation.realizations = sections;
    auto record = makeRecord(bench::measure(bench::Loudspeaker {}, setup));
    const auto model = fitEffects(record, {}, {});
    const auto curves = againstTime(compare(model, record));
    REQUIRE(curves.size() == 2);
    for (const auto& [name, curve] : curves) {
        INFO(name);
        REQUIRE(curve.argument.size() == sections);
        CHECK(curve.db < -50.0);
        double square = 0.0;  // in standard errors: the mean is 1
        for (std::size_t n = 0; n < sections; ++n)
            square += std::pow(curve.mean[n] / curve.scatter[n], 2) / sections;
        CHECK(square > 0.2);
        CHECK(square < 3.0);
    }
}
