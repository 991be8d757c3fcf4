// SPDX-License-Identifier: GPL-3.0-or-later
// What the air in a box and in its port does beyond the linear box, against the independent bench.
#include "Bench/Bench.h"
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/Portrait.h"
#include "Engine/Loudspeaker/Seen.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "SmallSetup.h"
#include "Loudspeaker/BenchTwin.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

using namespace excursion;

namespace {

constexpr double turn = 2.0 * std::numbers::pi, rate = 48000.0, distance = 0.3;  // m

struct Boxed {
    bench::Loudspeaker speaker;
    Model model;
};

/// A midbass in a box, on the bench and as a model: Kb, fB, 1/QP, 1/QL, 1/QA; loss either way in s/m and S in 1/m.
Boxed boxed(double outward, double inward, double S)
{
    const double Kb = 2400.0, fB = 38.0, dP = 0.08, dL = 0.12, dA = 0.03, wB = turn * fB;
    Boxed both;
    OperatingRange range;
    range.displacement = 4e-3;
    range.lowFrequency = 5.0;
    range.highFrequency = 10e3;
    both.model = withEffect(makeModel("electrodynamic"), effectNamed("vented-box"), range);
    const double box[] {Kb, fB, dP, dL, dA, 0.0, 1.0}, beyond[] {outward, inward, S};
    for (std::size_t k = 0; k < 7; ++k)
        both.model.components.back().parameters[k].value = box[k];
    both.model = withEffect(both.model, effectNamed("port-and-air"), range);
    for (std::size_t k = 0; k < 3; ++k)
        both.model.components.back().parameters[k].value = beyond[k];
    both.model.microphoneDistance = distance;
    both.model.path.parameters[1].value = distance / 343.0;
    auto& speaker = both.speaker;
    takeBase(speaker, both.model);
    const double mass = Kb / (wB * wB);
    speaker.ventedBox = bench::VentedBox {Kb, mass, mass * wB * dP, Kb / (wB * dL), Kb * dA / wB, 0.0};
    speaker.ventedBox->flow = bench::BoxFlow {mass * wB * outward, mass * wB * inward, 2.0, 1.0 / std::max(S, 1e-9)};
    speaker.coneArea = both.model.path.parameters[0].value;
    return both;
}

/// Half a second of tones around the tuning, V.
std::vector<double> tones()
{
    std::vector<double> u;
    const int length = static_cast<int>(0.5 * rate);
    for (int n = 0; n < length; ++n) {
        double sum = 0.0;
        for (const double f : {22.0, 31.0, 38.0, 57.0, 110.0})
            sum += 4.0 * std::sin(turn * f * n / rate + f);
        u.push_back(sum * std::min({1.0, n / (0.02 * rate), (length - n) / (0.02 * rate)}));
    }
    return u;
}

/// Away from the ends, where sound needs its filters.
double relativeDb(const std::vector<double>& a, const std::vector<double>& b)
{
    constexpr std::size_t ends = 2400;
    double error = 0.0, power = 0.0;
    for (std::size_t n = ends; n + ends < std::min(a.size(), b.size()); ++n) {
        error += (a[n] - b[n]) * (a[n] - b[n]);
        power += b[n] * b[n];
    }
    return 10.0 * std::log10(error / power);
}

}  // namespace

TEST_CASE("A turbulent port and air without exchange of heat move the model as the bench's loudspeaker", "[effects]")
{
    const auto [outward, inward, S] = GENERATE(
        table<double, double, double>({{0.4, 0.1, 0.0}, {0.1, 0.4, 0.0}, {0.0, 0.0, 12.0}, {0.3, 0.2, 12.0}}));
    INFO(outward << " and " << inward << " s/m, " << S << " 1/m");
    const auto [speaker, model] = boxed(outward, inward, S);
    auto linear = speaker;
    linear.ventedBox->flow.reset();
    const auto u = tones();
    const std::vector quantities {Quantity::current, Quantity::displacement, Quantity::pressure};
    const auto truth = bench::play(speaker, u, rate, quantities, distance),
               plain = bench::play(linear, u, rate, quantities, distance);
    SimulationOptions options;
    options.tolerance = 1e-6;
    const auto simulated = simulate(model, u, rate, options);
    for (const auto quantity : quantities) {
        INFO(name(quantity));
        const auto& y = truth.find(quantity)->samples;
        CHECK(relativeDb(plain.find(quantity)->samples, y) > -50.0);
        CHECK(relativeDb(simulated.find(quantity)->samples, y) < -80.0);
    }
}

TEST_CASE("Without its box what is within it does nothing, and goes with it", "[effects]")
{
    const auto model = boxed(0.3, 0.2, 12.0).model;
    CHECK(withoutEffect(model, "vented-box").effectIds().empty());
    CHECK(withoutEffect(model, "port-and-air").effectIds() == std::vector<std::string> {"vented-box"});
    const auto alone = withEffect(makeModel("electrodynamic"), effectNamed("port-and-air"), {});
    auto strong = alone;
    for (auto& p : strong.components.back().parameters)
        p.value = 0.3;
    const auto u = tones();
    CHECK(relativeDb(simulate(strong, u, rate, {}).find(Quantity::displacement)->samples,
                     simulate(alone, u, rate, {}).find(Quantity::displacement)->samples)
          < -200.0);
    CHECK_THAT(whyHostMissing(effectNamed("port-and-air"), makeModel("electrodynamic")), Catch::Contains("vented-box"));
    CHECK(whyHostMissing(effectNamed("port-and-air"), model).empty());
    CHECK(whyHostMissing(effectNamed("stiffness"), makeModel("electrodynamic")).empty());
}

TEST_CASE("A box that a fit moves takes along what is within it", "[effects]")
{
    auto [speaker, model] = boxed(0.3, 0.2, 12.0);
    bench::BenchSetup setup = smallSetup();
    setup.noiseDb = -90.0;
    setup.excitation.period = 16384;
    setup.excitation.levels = {1.0, 4.0};
    auto record = makeRecord(bench::measure(speaker, setup));
    const auto expected = model;
    for (auto [k, p, by] : {std::array {1, 1, 2}, {2, 0, -5}, {2, 2, 10}})
        model.components[static_cast<std::size_t>(k)].parameters[static_cast<std::size_t>(p)].value *= 1.0 + 0.01 * by;
    adapt(record, model);
    auto summary = fit(model, record, estimationSections(record), {});  // far from its end a search ends early
    summary = fit(model, record, estimationSections(record), {});
    CHECK(summary.usable());
    CHECK(model.components[2].operatingRange.host == valuesOf(model.components[1]));
    for (const std::size_t k : {1, 2})
        for (std::size_t p = 0; p < 2; ++p) {
            const auto& found = model.components[k].parameters[p];
            INFO(found.name);
            CHECK(std::abs(found.value - expected.components[k].parameters[p].value)
                  < 5.0 * found.standardError + 1e-3 * std::abs(found.value));
        }
    CHECK(summary.chiSquaredPerValue < 1.3);
}

TEST_CASE("The loop of a box's air has a band", "[effects]")
{
    auto model = boxed(0.3, 0.2, 12.0).model;
    const auto count = parameterVector(model).size();
    model.covariance = Eigen::MatrixXd::Zero(count, count);
    const auto air = firstParameterOf(model, 2) + 2;
    model.covariance(air, air) = 1.0;
    model.components[2].parameters[2].standardError = 1.0;
    const auto all = portraits(model);
    REQUIRE(all.size() == 1);
    const auto& widths = all.front().lines.front().halfWidth;
    CHECK(*std::max_element(widths.begin(), widths.end()) > 0.0);
}
