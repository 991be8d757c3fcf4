// SPDX-License-Identifier: GPL-3.0-or-later
// A circuit may stand for a driver, and a file may be in the wrong unit: numbers of any size mean the same.
#include "Loudspeaker/EffectBench.h"

#include "Engine/Loudspeaker/FitResponse.h"
#include "Engine/Loudspeaker/ModelFile.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Loudspeaker/Trajectory.h"
#include "Engine/Numerics/Exponential.h"
#include "Engine/Numerics/StateUnits.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <Eigen/Eigenvalues>

using namespace excursion;

namespace {

/// A mechanical-only driver with a bent spring, whose force and displacement are told in units so many times smaller.
Model bentSpring(double force, double displacement, double bend)
{
    auto model = makeModel("mechanical");
    for (auto& p : model.components.front().parameters)
        p.value *= force / displacement;
    auto operatingRange = someOperatingRange(1.0);
    operatingRange.displacement *= displacement;
    operatingRange.velocity *= displacement;
    model = withEffect(model, effectNamed("stiffness"), operatingRange);
    model.components.back().parameters[1].value = bend * model.baseParameter("K").value;
    return model;
}

std::vector<double> push(double force, double sampleRate)
{
    std::vector<double> u;
    for (int n = 0; n < 600; ++n)
        u.push_back(6.0 * force * std::sin(2.0 * std::numbers::pi * 60.0 * n / sampleRate));
    return u;
}

const std::vector<std::pair<double, double>> units {{1e-6, 1e6}, {1e6, 1e-6}, {1e6, 1e6}, {3.4e-5, 2.2e-6}};

}  // namespace

TEST_CASE("An exponential and its poles keep their digits in any unit", "[units]")
{
    auto operatingRange = someOperatingRange(1.0);
    auto model = makeModel("electrodynamic");
    for (const char* effect : {"eddy-currents", "creep"}) {
        model = withEffect(model, effectNamed(effect), operatingRange);
        model.components.back().parameters.front().value = someScale(effectNamed(effect));
    }
    if (GENERATE(false, true))
        model.components.back().parameters.front().value = 0.0;  // relaxations that move nothing
    const auto linear = smallSignal(model);
    const auto n = linear.A.rows();
    Eigen::VectorXd sizes(n);
    for (Eigen::Index k = 0; k < n; ++k)
        sizes[k] = std::pow(10.0, 12.0 * std::sin(3.0 + 2.0 * static_cast<double>(k)));
    const Eigen::MatrixXd A = inUnits(linear.A, sizes);
    const Eigen::VectorXd b = linear.B.cwiseQuotient(sizes);
    const auto plain = exponential(linear.A, linear.B, 1e-4, 4), other = exponential(A, b, 1e-4, 4);
    const Eigen::VectorXd own = stateUnits(linear.A), back = own.cwiseQuotient(sizes);
    const Eigen::MatrixXd decay = inUnits(plain.decay, own), otherDecay = inUnits(other.decay, back);
    CHECK((otherDecay - decay).cwiseAbs().maxCoeff() < 1e-12 * decay.cwiseAbs().maxCoeff());
    const Eigen::MatrixXd phi = own.cwiseInverse().asDiagonal() * plain.phi,
                          otherPhi = back.cwiseInverse().asDiagonal() * other.phi;
    CHECK((otherPhi - phi).cwiseAbs().maxCoeff() < 1e-12 * phi.cwiseAbs().maxCoeff());

    const auto sorted = [](Eigen::VectorXcd values) {
        std::sort(values.begin(), values.end(),
                  [](auto a, auto b) { return std::pair(a.real(), a.imag()) < std::pair(b.real(), b.imag()); });
        return values;
    };
    SmallSignal scaled;
    scaled.A = A;
    const auto expected = sorted(poles(linear)), found = sorted(poles(scaled));
    for (Eigen::Index k = 0; k < n; ++k)
        CHECK(std::abs(found[k] - expected[k]) < 1e-9 * std::abs(expected[k]));
}

TEST_CASE("A driver moves alike in any unit, and one that runs away is told", "[units]")
{
    constexpr double rate = 8000.0;
    Trajectory plain, other;
    REQUIRE(integrate(bentSpring(1.0, 1.0, 0.4), Drive(push(1.0, rate), rate, 2), {}, plain));
    const double peak = *std::max_element(plain.displacement.begin(), plain.displacement.end());
    CHECK(peak > 2e-3);  // far enough to bend the spring
    for (const auto& [force, displacement] : units) {
        INFO(force << " " << displacement);
        REQUIRE(integrate(bentSpring(force, displacement, 0.4), Drive(push(force, rate), rate, 2), {}, other));
        double worst = 0.0;
        for (std::size_t n = 0; n < plain.displacement.size(); ++n)
            worst = std::max(worst, std::abs(other.displacement[n] / displacement - plain.displacement[n]));
        CHECK(worst < 1e-10 * peak);
        // pushes outward
        CHECK_FALSE(integrate(bentSpring(force, displacement, -3.0), Drive(push(force, rate), rate, 2), {}, other));
        const auto linear = smallSignal(bentSpring(force, displacement, 0.4));
        CHECK(-linear.A(2, 1) == Approx(2e5).epsilon(1e-8));  // K/m at rest
    }
}

TEST_CASE("A motion and a pressure of any size have a start", "[units]")
{
    auto truth = makeModel("electrodynamic");
    truth.path.parameters[1].value = 2.9e-3;  // the flight over a metre
    std::vector<double> frequency;
    for (double f = 15.0; f < 5000.0; f *= 1.1)
        frequency.push_back(f);
    const std::vector<Quantity> quantities {Quantity::current, Quantity::displacement, Quantity::pressure};
    const auto responses = respond(truth, quantities, frequency);
    const bool motion = GENERATE(true, false), area = GENERATE(true, false);
    for (const double size : {1.0, 1e-6, 1e6, 3e-4})
        for (const double heard : {1.0, 2e-5, 1e6}) {
            INFO("displacement " << size << " pressure " << heard << (motion ? "" : ", no motion")
                                 << (area ? "" : ", no area"));
            std::vector<ResponseTarget> targets;
            for (std::size_t q = 0; q < quantities.size(); ++q) {
                if (!motion && quantities[q] == Quantity::displacement)
                    continue;
                ResponseTarget target;
                target.quantity = quantities[q];
                target.frequency = frequency;
                target.value = responses[q].value;
                for (auto& value : target.value) {
                    value *= quantities[q] == Quantity::displacement ? size
                             : quantities[q] == Quantity::pressure   ? heard
                                                                     : 1.0;
                    target.deviation.push_back(0.01 * std::abs(value));
                }
                targets.push_back(std::move(target));
            }
            DriverInfo driver;
            driver.microphoneDistance = 1.0;
            if (area)
                driver.coneArea = 0.01;
            const auto model = startModel(targets, true, driver);
            for (const auto& target : targets)
                CHECK(responseErrorDb(model, target) < -60.0);
            CHECK(model.baseParameter("m").free == (motion || area));
            CHECK(model.path.parameters[0].free == (motion || !area));
            CHECK((caveatsOf(model).find("area of the cone") != std::string::npos) == (!motion && !area));
            if (motion)
                CHECK(model.baseParameter("m").value == Approx(0.01 / (size * size)).epsilon(1e-3));
        }
}

TEST_CASE("A model in any unit is read as it was written", "[units]")
{
    for (const auto& [force, displacement] : units) {
        const auto model = bentSpring(force, displacement, 0.4);
        const auto read = modelFromJson(nlohmann::json::parse(toJson(model).dump()), "some model");
        CHECK(parameterVector(read) == parameterVector(model));
        CHECK(read.components.back().operatingRange.displacement
              == model.components.back().operatingRange.displacement);
    }
}
