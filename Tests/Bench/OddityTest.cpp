// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Draw.h"
#include "Bench/OddForce.h"
#include "Bench/Random.h"
#include "Engine/Error.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace excursion;
using namespace excursion::bench;

namespace {

constexpr double step = 1e-4;  // s

/// Force after a motion at constant velocity that lasts some steps, m/s.
double moved(OddForce& force, double& x, double v, int steps)
{
    double last = 0.0;
    for (int n = 0; n < steps; ++n) {
        const auto& c = Radau::points();
        last = force.force({x + c[0] * step * v, x + c[1] * step * v, x + step * v}, {v, v, v})[2];
        force.finish();
        x += step * v;
    }
    return last;
}

double largestDifference(const Measurement& a, const Measurement& b, Quantity quantity)
{
    const auto &one = a.find(quantity)->samples, &other = b.find(quantity)->samples;
    double most = 0.0;
    for (std::size_t n = 0; n < one.size(); ++n)
        most = std::max(most, std::abs(one[n] - other[n]));
    return most;
}

}  // namespace

TEST_CASE("A contact pushes back on one side, beyond its gap", "[oddity]")
{
    Oddity contact;
    contact.side = -1.0;
    contact.gap = 1e-3;
    contact.stiffness = 2e5;
    OddForce force(contact, step);
    CHECK(force.force({5e-3, 0.0, -0.9e-3}, {})[2] == 0.0);
    const auto pushed = force.force({5e-3, -1e-3, -3e-3}, {});
    CHECK(pushed[0] == 0.0);
    CHECK(pushed[2] == Approx(2e5 * std::pow(2e-3, 1.5)));
}

TEST_CASE("Bouc-Wen's hysteresis follows its closed form", "[oddity]")
{
    Oddity hysteresis;
    hysteresis.kind = Oddity::Kind::hysteresis;
    hysteresis.stiffness = 3000.0;
    hysteresis.limit = 0.5e-3;
    hysteresis.exponent = 1.0;
    hysteresis.pinch = 0.5;
    OddForce force(hysteresis, step);
    double x = 0.0;
    // z = limit (1 - exp(-x/limit)) while it is loaded; unloading is linear for n = 1, b = 1/2
    const double loaded = moved(force, x, 0.02, 400);
    CHECK(x == Approx(0.8e-3));
    CHECK(loaded == Approx(-3000.0 * 0.5e-3 * (1.0 - std::exp(-1.6))).epsilon(1e-4));
    CHECK(moved(force, x, -0.02, 100) == Approx(loaded + 3000.0 * 0.2e-3).epsilon(1e-4));
}

TEST_CASE("A rest that jumps has two places, a wandering stiffness the depth that was asked for", "[oddity]")
{
    Random random(5);
    const auto jump = drawOddity("jump", 0.1, 1000.0, 2e-3, random);
    OddForce leaps(jump, 1e-3);
    int low = 0, high = 0, count = 0;
    for (; count < 60000; ++count) {
        const double offset = leaps.force({}, {})[2] / 1000.0;
        low += std::abs(offset) < 1e-9;
        high += std::abs(offset - 0.2e-3) < 1e-9;
        leaps.finish();
    }
    CHECK(low > count / 5);
    CHECK(high > count / 5);
    CHECK(low + high > count * 9 / 10);

    const auto wander = drawOddity("wander", 0.03, 1000.0, 2e-3, random);
    OddForce drifts(wander, 1e-2);
    double square = 0.0;
    constexpr int times = 60000;  // 600 s
    for (int n = 0; n < times; ++n) {
        square += std::pow(drifts.force({1.0, 1.0, 1.0}, {})[2] / 1000.0, 2);
        drifts.finish();
    }
    CHECK(std::sqrt(square / times) == Approx(0.03).epsilon(0.1));
    CHECK_THROWS_AS(drawOddity("ghost", 0.1, 1.0, 1.0, random), Error);
}

TEST_CASE("Every oddity changes a take and a contact out of reach does not", "[oddity]")
{
    DrawOptions options;
    options.hidden.emplace();
    options.seconds = 1.0;
    options.driver = "midbass";
    options.channels = {{Quantity::voltage, Quantity::displacement}};
    auto drawn = draw(3, options);
    drawn.setup.noiseDb = -std::numeric_limits<double>::infinity();
    drawn.setup.excitation.realizations = 1;
    const auto plain = measure(drawn.speaker, drawn.setup);
    for (const auto& name : oddityNames()) {
        INFO(name);
        options.oddity = name;
        auto odd = draw(3, options).speaker;
        CHECK(largestDifference(plain, measure(odd, drawn.setup), Quantity::displacement)
              > 1e-3 * drawn.visited.displacement);
        if (name == "contact") {
            odd.oddity->gap = 3.0 * drawn.visited.displacement;
            CHECK(largestDifference(plain, measure(odd, drawn.setup), Quantity::displacement) == 0.0);
        }
    }
}
