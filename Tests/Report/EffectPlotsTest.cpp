// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Catalogue.h"
#include "Plots/Plots.h"
#include "Plots/Words.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace excursion;

namespace {

bool isFinite(const std::vector<double>& values)
{
    return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

}  // namespace

TEST_CASE("Each effect that is no mere response has its picture, in the model's order", "[report]")
{
    OperatingRange range;
    range.displacement = 2e-3;
    range.current = 4.0;
    range.duration = 6.0;
    auto model = makeModel("electrodynamic");
    for (const char* id : {"friction", "eddy-currents", "coil-heating", "stiffness", "doppler"}) {
        model = withEffect(std::move(model), effectNamed(id), range);
        for (auto& p : model.components.back().parameters)
            if (p.strength)
                p.value = std::isfinite(p.prior) ? 0.1 * p.prior : 1.0 / 343.0;
    }
    const auto plots = effectPlots(model);
    REQUIRE(plots.size() == 4);
    const char* expected[] = {"friction", "coil-heating", "stiffness", "doppler"};
    for (std::size_t n = 0; n < plots.size(); ++n) {
        INFO(expected[n]);
        CHECK(plots[n].title == effectTitle(expected[n]));
        CHECK_FALSE(plots[n].y.unit.empty());
        for (const auto& series : plots[n].series) {
            CHECK(series.x.size() == series.y.size());
            CHECK((series.x.size() >= 2 && isFinite(series.x) && isFinite(series.y)));
        }
    }
    const auto& loops = plots[0].series;
    REQUIRE(loops.size() == 3);
    for (std::size_t n = 0; n < loops.size(); ++n) {
        CHECK(largest(loops[n].x) == Approx(2.0 / std::exp2(n)).epsilon(1e-6));  // mm
        CHECK(std::hypot(loops[n].x.front() - loops[n].x.back(), loops[n].y.front() - loops[n].y.back())
              < 1e-3 * largest(loops[n].y));  // closed
    }
    CHECK(loops[0].dash != loops[1].dash);
    CHECK(loops[1].dash != loops[2].dash);
    const auto& drift = plots[1].series;
    REQUIRE(drift.size() == 2);  // cold, and as it warms
    CHECK(std::is_sorted(drift[1].y.begin(), drift[1].y.end()));
    CHECK(drift[0].y.back() == drift[1].y.front());
    const auto& sound = plots[3].series;
    REQUIRE(sound.size() == 2);  // at the speed of sound, which is what was put in
    CHECK(sound[0].y.front() == Approx(sound[1].y.front()));
    CHECK(sound[0].y.back() == Approx(sound[1].y.back()));
}
