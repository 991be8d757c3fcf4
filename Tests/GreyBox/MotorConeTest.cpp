// SPDX-License-Identifier: GPL-3.0-or-later
// Loudspeakers of known motor and cone, as closed formulas in s, told apart from noisy responses.
#include "Engine/GreyBox/CascadeRefinement.h"
#include "Engine/GreyBox/MotorCone.h"
#include "Engine/Linear/Response.h"
#include "Linear/Problem.h"

#include <cmath>
#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Complex = std::complex<double>;

namespace {

constexpr double fullTurn = 2.0 * std::numbers::pi;

/// A driver with one voice coil and a cone that breaks up: lumped elements and modes.
struct Loudspeaker {
    double Re = 3.3, Le = 266e-6, Bl = 4.95, m = 14.35e-3, r = 0.786, k = 1852;
    double air = 0.05;  // rho Sd / (2 pi d), Pa / (m/s^2)
    struct Mode {
        double frequency, quality, share;
    };
    std::vector<Mode> modes;
    double box = 0.0;  // share of a resonance at 150 Hz of the air behind the cone

    Complex displacement(Complex s) const
    {
        const double w = fullTurn * 150.0;
        return (1.0 + box * w * w / (s * s + w / 6.0 * s + w * w)) * Bl
               / ((Le * s + Re) * (m * s * s + r * s + k) + Bl * Bl * s);
    }
    Complex cone(Complex s) const
    {
        Complex sum = 1.0;
        for (const auto& mode : modes) {
            const double w = fullTurn * mode.frequency;
            sum += mode.share * s * s / (s * s + w / mode.quality * s + w * w);
        }
        return air * sum;
    }
    Complex pressure(Complex s) const { return cone(s) * s * s * displacement(s); }
};

double between(Normal& normal, double low, double high)
{
    return low + (high - low) * 0.5 * std::erfc(-normal() / std::numbers::sqrt2);
}

Loudspeaker random(Normal& normal)
{
    Loudspeaker l;
    l.Re = between(normal, 3.0, 8.0);
    l.Le = between(normal, 1e-4, 1e-3);
    l.Bl = between(normal, 4.0, 11.0);
    l.m = between(normal, 5e-3, 40e-3);
    const double w0 = fullTurn * between(normal, 30.0, 90.0);
    l.k = l.m * w0 * w0;
    l.r = l.m * w0 / between(normal, 2.0, 7.0);
    for (int i = 0; i < 4; ++i)
        l.modes.push_back({between(normal, 0.9, 1.1) * 700.0 * std::pow(1.8, i), between(normal, 4.0, 15.0),
                           between(normal, 0.1, 0.5) * (i % 2 ? -1.0 : 1.0)});
    return l;
}

Complex axis(double f) { return {0.0, fullTurn * f}; }

struct TakenResponses {
    FrequencyData displacement, pressure;
};

/// 10 Hz to 10 kHz. The displacement's noise is even, 10 dB below the displacement at `drowned` Hz; the pressure's -60
/// dB of its rms. 0: no noise.
TakenResponses measured(const Loudspeaker& l, double drowned, Normal& normal, int lines = 400)
{
    TakenResponses result;
    for (int i = 0; i < lines; ++i)
        result.displacement.frequency.push_back(10.0 * std::pow(1000.0, static_cast<double>(i) / (lines - 1)));
    result.pressure.frequency = result.displacement.frequency;
    result.displacement.value.resize(lines, 1);
    result.pressure.value.resize(lines, 1);
    for (Eigen::Index i = 0; i < lines; ++i) {
        const Complex s = axis(result.pressure.frequency[static_cast<std::size_t>(i)]);
        result.displacement.value(i, 0) = l.displacement(s);
        result.pressure.value(i, 0) = l.pressure(s);
    }
    if (drowned == 0.0)
        return result;
    const double quiet = std::abs(l.displacement(axis(drowned))) / std::sqrt(10.0),
                 hiss = 1e-3 * result.pressure.value.norm() / std::sqrt(lines);
    for (auto* data : {&result.displacement, &result.pressure}) {
        data->deviation = Eigen::MatrixXd::Constant(lines, 1, data == &result.pressure ? hiss : quiet);
        for (Eigen::Index i = 0; i < lines; ++i)
            data->value(i, 0) += data->deviation(i, 0) * Complex(normal(), normal()) / std::numbers::sqrt2;
    }
    return result;
}

/// Relative rms error in dB of one output of a model to a truth, from `low` to `high` Hz.
template <class Truth>
double errorDb(const StateSpace& model, Eigen::Index output, double low, double high, Truth truth)
{
    double error = 0.0, power = 0.0;
    for (int i = 0; i < 500; ++i) {
        const double f = low * std::pow(high / low, i / 499.0);
        const Complex expected = truth(axis(f));
        error += std::norm(respond(model, {f})[0](output, 0) - expected);
        power += std::norm(expected);
    }
    return 10.0 * std::log10(error / power);
}

MotorConeOptions orders(int motor, int cone)
{
    MotorConeOptions options;
    options.motorOrder = motor;
    options.coneOrder = cone;
    return options;
}

}  // namespace

TEST_CASE("Without noise motor and cone are told apart to rounding, and the motor's states are displacement, velocity "
          "and acceleration")
{
    Normal normal(1);
    for (int trial = 0; trial < 4; ++trial) {
        const auto l = random(normal);
        const auto data = measured(l, 0.0, normal);
        const auto found = identifyMotorCone(data.displacement, data.pressure, orders(3, 8));
        REQUIRE(found.motor.order() == 3);
        REQUIRE(found.cone.order() == 8);
        CHECK(found.cascade.order() == 11);
        CHECK(found.stable);
        CHECK(found.errorDb < -130.0);
        CHECK(errorDb(found.cascade, 0, 11.0, 9000.0, [&](Complex s) { return l.pressure(s); }) < -130.0);
        CHECK(errorDb(found.cone, 0, 11.0, 9000.0, [&](Complex s) { return l.cone(s); }) < -130.0);
        // s^3 x = (Bl u - a_0 x - a_1 v - a_2 a)/(Le m), by hand from both laws
        const double unit = l.Le * l.m;
        Eigen::Matrix3d A;
        A << 0, 1, 0, 0, 0, 1, -l.Re * l.k / unit, -(l.Re * l.r + l.Le * l.k + l.Bl * l.Bl) / unit,
            -(l.Re * l.m + l.Le * l.r) / unit;
        for (Eigen::Index c = 0; c < 3; ++c) {
            CHECK(found.motor.A(2, c) == Approx(A(2, c)).epsilon(1e-6));
            CHECK((found.motor.A.col(c).head(2) - A.col(c).head(2)).norm() == 0.0);
        }
        CHECK(found.motor.B(2, 0) == Approx(l.Bl / unit).epsilon(1e-6));
        CHECK(found.motor.C == Eigen::Matrix3d::Identity());
        CHECK_THAT(found.sentence, Catch::Contains("not known"));
    }
}

TEST_CASE("With noise the cascade is below the noise of the pressure, and the split is told as far as the displacement "
          "is heard",
          "[slow]")
{
    Normal normal(2);
    for (const double drowned : {1500.0, 500.0})
        for (int trial = 0; trial < 5; ++trial) {
            const auto l = random(normal);
            const auto data = measured(l, drowned, normal);
            const auto found = identifyMotorCone(data.displacement, data.pressure, orders(3, 8));
            const auto pressureDb = errorDb(found.cascade, 0, 11.0, 9000.0, [&](Complex s) { return l.pressure(s); });
            const auto coneDb = errorDb(found.cone, 0, 30.0, drowned, [&](Complex s) { return l.cone(s); });
            const auto movedDb = errorDb(found.motor, 0, 11.0, drowned, [&](Complex s) { return l.displacement(s); });
            const auto fastDb = errorDb(found.motor, 1, 11.0, drowned,
                                        [&](Complex s) { return s * l.displacement(s); });
            const auto acceleratedDb = errorDb(found.motor, 2, 11.0, drowned,
                                               [&](Complex s) { return s * s * l.displacement(s); });
            CAPTURE(drowned, trial, found.errorDb, pressureDb, coneDb, movedDb, fastDb, acceleratedDb,
                    found.motorChiSquared, found.chiSquared);
            CHECK(found.stable);
            CHECK(found.from == ConeFrom::motor);
            // 800 real values of unit variance less 4, and less 17: one standard deviation is 5 %.
            CHECK(found.motorChiSquared == Approx(400.0).margin(80.0));
            CHECK(found.chiSquared == Approx(400.0).margin(80.0));
            CHECK(found.errorDb == Approx(-60.0).margin(1.0));  // the noise
            CHECK(found.refined);
            CHECK(pressureDb < -73.0);
            CHECK(coneDb < -60.0);
            CHECK(movedDb < -62.0);
            CHECK(fastDb < -62.0);
            CHECK(acceleratedDb < -60.0);
            CHECK(found.toldUpTo == Approx(drowned).epsilon(0.04));
            for (std::size_t i = 0; i < found.told.size(); ++i)
                CHECK(found.told[i] == (data.pressure.frequency[i] <= found.toldUpTo));
            CHECK_THAT(found.sentence, Catch::Contains("only motor and cone together are measured"));
        }
}

TEST_CASE(
    "A motor of too low an order does not spoil the cone where the displacement is told, and the likelihood tells")
{
    Normal normal(3);
    for (int trial = 0; trial < 3; ++trial) {
        auto l = random(normal);
        l.box = 0.1;  // 2 more states in the displacement, and thereby in the pressure
        const auto data = measured(l, 1500.0, normal);
        const auto low = identifyMotorCone(data.displacement, data.pressure, orders(3, 8));
        auto options = orders(3, 8);
        options.from = ConeFrom::motor;
        const auto spoiled = identifyMotorCone(data.displacement, data.pressure, options);
        const auto coneDb = [&](const MotorCone& found) {
            return errorDb(found.cone, 0, 30.0, 1000.0, [&](Complex s) { return l.cone(s); });
        };
        const auto high = identifyMotorCone(data.displacement, data.pressure, orders(5, 8));
        CAPTURE(trial, low.motorChiSquared, low.errorDb, high.motorChiSquared, high.chiSquared, coneDb(low),
                coneDb(spoiled), coneDb(high));
        CHECK(low.from == ConeFrom::quotient);
        CHECK(low.motorChiSquared > 2000.0);
        CHECK_FALSE(low.refined);
        CHECK(coneDb(low) < -25.0);
        CHECK(coneDb(low) < coneDb(spoiled) - 6.0);
        CHECK(low.errorDb > -20.0);  // the cascade has the motor's error, and says so
        CHECK(high.from == ConeFrom::motor);
        CHECK(high.chiSquared < 480.0);
        CHECK(coneDb(high) < -70.0);
    }
}

TEST_CASE(
    "The variance of the cone's response is that of the quotient, and the sound's way to the microphone is taken off")
{
    Normal normal(4);
    const auto l = random(normal);
    const double delay = 1.1e-3;
    double square = 0.0;
    int count = 0;
    for (int draw = 0; draw < 20; ++draw) {
        auto data = measured(l, 1500.0, normal, 60);
        for (Eigen::Index i = 0; i < data.pressure.lines(); ++i)
            data.pressure.value(i, 0) *= std::exp(-delay * axis(data.pressure.frequency[static_cast<std::size_t>(i)]));
        auto options = orders(3, 8);
        options.delay = delay;
        options.from = ConeFrom::quotient;
        options.leastSignalDb = 20.0;
        options.thorough = false;
        const auto found = identifyMotorCone(data.displacement, data.pressure, options);
        CHECK(errorDb(found.cascade, 0, 30.0, 700.0, [&](Complex s) { return l.pressure(s); }) < -30.0);
        for (std::size_t i = 0; i < found.told.size(); ++i)
            if (found.told[i]) {
                const auto k = static_cast<Eigen::Index>(i);
                const auto error = found.coneResponse.value(k, 0) - l.cone(axis(data.pressure.frequency[i]));
                square += std::norm(error / found.coneResponse.deviation(k, 0));
                ++count;
            }
    }
    REQUIRE(count > 400);
    CHECK(square / count == Approx(1.0).margin(0.2));  // 4 standard deviations
}

TEST_CASE("With next to no inductance the displacement falls by two powers only, and the motor has two states")
{
    Normal normal(5);
    auto l = random(normal);
    l.Le = 0.0;
    const auto data = measured(l, 0.0, normal);
    auto options = orders(2, 8);
    options.relativeDegree = 2;
    const auto found = identifyMotorCone(data.displacement, data.pressure, options);
    CHECK(found.errorDb < -130.0);
    CHECK(found.motor.A(1, 0) == Approx(-l.k / l.m).epsilon(1e-6));
    CHECK(found.motor.A(1, 1) == Approx(-(l.r + l.Bl * l.Bl / l.Re) / l.m).epsilon(1e-6));
    CHECK(found.motor.B(1, 0) == Approx(l.Bl / l.Re / l.m).epsilon(1e-6));
    CHECK(errorDb(found.motor, 2, 11.0, 9000.0, [&](Complex s) { return s * s * l.displacement(s); }) < -130.0);
}

TEST_CASE("Responses that tell no motor and no cone are refused in a sentence")
{
    Normal normal(6);
    const auto l = random(normal);
    const auto data = measured(l, 500.0, normal, 60);
    auto options = orders(2, 8);
    refused(Error::Kind::usage, "relative degree",
            [&] { identifyMotorCone(data.displacement, data.pressure, options); });
    options = orders(3, 8);
    options.relativeDegree = 1;
    refused(Error::Kind::usage, "2 or 3", [&] { identifyMotorCone(data.displacement, data.pressure, options); });
    options = orders(3, 8);
    options.delay = std::numeric_limits<double>::infinity();
    refused(Error::Kind::usage, "delay", [&] { identifyMotorCone(data.displacement, data.pressure, options); });
    auto other = data.pressure;
    other.frequency.back() *= 1.1;
    refused(Error::Kind::data, "same frequencies", [&] { identifyMotorCone(data.displacement, other, orders(3, 8)); });
    other = data.pressure;
    other.value(3, 0) = std::numeric_limits<double>::quiet_NaN();
    refused(Error::Kind::data, "not finite", [&] { identifyMotorCone(data.displacement, other, orders(3, 8)); });
    auto still = data.displacement;
    still.value(5, 0) = 0.0;
    refused(Error::Kind::data, "zero at a frequency", [&] { identifyMotorCone(still, data.pressure, orders(3, 8)); });
    auto deaf = data.displacement;
    deaf.deviation *= 1e6;
    refused(Error::Kind::data, "too few frequencies", [&] { identifyMotorCone(deaf, data.pressure, orders(3, 8)); });
    auto two = data.pressure;
    two.outputs = 2;
    two.value = two.value.replicate(1, 2).eval();
    two.deviation = two.deviation.replicate(1, 2).eval();
    refused(Error::Kind::data, "one displacement and one pressure",
            [&] { identifyMotorCone(data.displacement, two, orders(3, 8)); });
}

TEST_CASE("Partial fractions of a relative degree have Markov parameters of zero, and their refinement finds the least "
          "error among those")
{
    Normal normal(7);
    for (const int degree : {1, 2, 3}) {
        const auto l = random(normal);
        const auto data = measured(l, 800.0, normal, 120).displacement;
        const double unit = fullTurn * data.frequency.back();
        auto sections = sectionsOf({unit * Complex(-0.01, 0.02), unit * Complex(-0.01, -0.02), -0.3 * unit}, 0.0, unit);
        sections.relativeDegree = degree;
        const auto fit = fitPartialFractions(sections, data);
        auto model = realize(sections, fit.C, fit.D);
        model.A /= unit;
        model.B /= unit;
        const double size = model.C.norm() * model.B.norm();
        CHECK(std::abs(model.D(0, 0)) < 1e-14 * size);
        if (degree > 1)
            CHECK(std::abs((model.C * model.B)(0, 0)) < 1e-12 * size);
        if (degree > 2)
            CHECK(std::abs((model.C * model.A * model.B)(0, 0)) < 1e-12 * size);
        PoleRefinementOptions options;
        options.maximumIterations = 300;
        options.costTolerance = 1e-12;
        const auto refined = refinePoles(sections, data, options);
        CHECK(refined.fit.cost < fit.cost);
        // A minimum: no factor alone can be moved to lower the error.
        for (Eigen::Index k = 0; k < 3; ++k)
            for (const double by : {-1e-3, 1e-3}) {
                auto moved = refined.fit.sections;
                moved.factors[k] *= 1.0 + by;
                CHECK(fitPartialFractions(moved, data).cost >= refined.fit.cost * (1.0 - 1e-9));
            }
    }
    auto sections = sectionsOf({-1.0, -2.0}, 0.0, 1.0);
    sections.relativeDegree = 3;
    const auto data = measured(random(normal), 800.0, normal, 120).displacement;
    refused(Error::Kind::usage, "relative degree", [&] { fitPartialFractions(sections, data); });
}

TEST_CASE("A cascade is refined to a minimum, from halves that are off, and refuses what is none")
{
    Normal normal(8);
    const auto l = random(normal);
    const auto data = measured(l, 800.0, normal);
    const double unit = fullTurn * 1e4;
    const auto start = [&](const StateSpace& model, int relativeDegree, const FrequencyData& response) {
        auto sections = sectionsOf(poles(model), 0.0, unit);
        sections.factors *= 1.02;
        sections.relativeDegree = relativeDegree;
        return fitPartialFractions(sections, response);
    };
    const auto found = identifyMotorCone(data.displacement, data.pressure, orders(3, 8));
    const auto motor = start(found.motor, 3, data.displacement), cone = start(found.cone, 0, found.coneResponse);
    const auto refined = refineCascade(motor, cone, data.displacement, data.pressure);
    CHECK(refined.converged());
    CHECK(refined.finalCost == Approx(800.0).margin(115.0));  // 1600 real values: 4 standard deviations
    CHECK(refined.finalCost == Approx(found.motorChiSquared + found.chiSquared).epsilon(1e-4));
    const auto model = realize(refined.first.sections, refined.first.C, refined.first.D);
    CHECK(std::abs((model.C * model.A * model.B)(0, 0)) < 1e-9 * (model.C.norm() * model.A.norm() * model.B.norm()));
    auto loose = motor;
    loose.sections.relativeDegree = 0;
    refused(Error::Kind::usage, "relative degree",
            [&] { refineCascade(loose, cone, data.displacement, data.pressure); });
    auto blind = data.pressure;
    blind.deviation.resize(0, 0);
    refused(Error::Kind::usage, "deviations", [&] { refineCascade(motor, cone, data.displacement, blind); });
}
