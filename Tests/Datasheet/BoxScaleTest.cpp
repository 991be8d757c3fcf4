// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Datasheet/KnownScale.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/Simulate.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace excursion;

TEST_CASE("A known scale takes the air of a box along", "[datasheet]")
{
    constexpr double rate = 48000.0;
    OperatingRange range;
    range.displacement = 4e-3;
    range.lowFrequency = 5.0;
    auto model = makeModel("electrodynamic");
    for (const auto& [id, values] : {std::pair {"vented-box", std::vector {2400.0, 38.0, 0.08, 0.12, 0.03, 0.0, 1.0}},
                                     {"port-and-air", std::vector {0.3, 0.2, 12.0}}}) {
        model = withEffect(std::move(model), effectNamed(id), range);
        for (std::size_t k = 0; k < values.size(); ++k)
            model.components.back().parameters[k].value = values[k];
    }
    tellHosts(model);
    std::vector<double> u;
    for (int n = 0; n < static_cast<int>(0.3 * rate); ++n)
        u.push_back(10.0 * std::sin(2.0 * std::numbers::pi * 38.0 * n / rate));
    SimulationOptions options;
    options.tolerance = 1e-6;
    const auto one = simulate(model, u, rate, options), half = simulate(withMotion(model, 0.5), u, rate, options),
               linear = simulate(withoutEffect(model, "port-and-air"), u, rate, options);
    const auto difference = [&](const Measurement& other, double times) {
        double error = 0.0, power = 0.0;
        for (std::size_t n = 0; n < u.size(); ++n) {
            const double x = one.find(Quantity::displacement)->samples[n];
            error += std::pow(times * other.find(Quantity::displacement)->samples[n] - x, 2);
            power += x * x;
        }
        return 10.0 * std::log10(error / power);
    };
    CHECK(difference(linear, 1.0) > -40.0);
    CHECK(difference(half, 2.0) < -90.0);
}
