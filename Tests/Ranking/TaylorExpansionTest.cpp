// SPDX-License-Identifier: GPL-3.0-or-later
// The physical driver as a polynomial model: coefficients by hand, and simulations of both.
#include "Engine/Error.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalSimulation.h"
#include "Engine/Ranking/TaylorExpansion.h"
#include "Predistortion/Drivers.h"

#include <catch2/catch.hpp>

using namespace excursion;
using Eigen::Index;

namespace {

/// Of the monomial i^a x^b v^c u^d in the row of a state; 0 where it is not there. Memories are not in it.
double coefficient(const FractionalPnlss& model, Index row, const Eigen::RowVector4i& exponents)
{
    Eigen::RowVectorXi wanted = Eigen::RowVectorXi::Zero(model.form.exponents.cols());
    wanted.head<3>() = exponents.head<3>();
    wanted[wanted.size() - 1] = exponents[3];
    for (Index k = 0; k < model.form.terms(); ++k)
        if (model.form.exponents.row(k) == wanted)
            return model.form.E(row, k);
    return 0.0;
}

/// Laws of degree 2 given by their monomials b_1 q + b_2 q^2, as Chebyshev coefficients over the operating range.
Model withLaw(const Model& plain, const char* id, double b1, double b2)
{
    OperatingRange operatingRange;
    operatingRange.displacement = xmax;
    operatingRange.velocity = 2.0;
    operatingRange.current = 10.0;
    operatingRange.degree = 2;
    auto model = withEffect(plain, effectNamed(id), operatingRange);
    auto& parameters = model.components.back().parameters;
    const double range = operatingRange.displacement;
    parameters[0].value = b1 * range;
    parameters[1].value = 0.5 * b2 * range * range;
    return model;
}

/// A burst of two tones that begins and ends in silence.
std::vector<double> burst(double rate, double amplitude)
{
    std::vector<double> u(8000);
    for (std::size_t t = 0; t < u.size(); ++t) {
        const double s = static_cast<double>(t) / rate, bell = (static_cast<double>(t) - 3500.0) / 800.0;
        u[t] = amplitude * std::exp(-0.5 * bell * bell)
               * (std::sin(2.0 * std::numbers::pi * 55.0 * s) + 0.5 * std::sin(2.0 * std::numbers::pi * 240.0 * s));
    }
    return u;
}

}  // namespace

TEST_CASE("The coefficients of a driver's expansion are those that a person derives")
{
    const double R = 3.3, L = 266e-6, Bl = 4.95, m = 0.01435;
    const double b1 = 40.0, b2 = -6e4, k1 = -3e4, k2 = 2e7, l1 = -0.012, l2 = 1.5;
    auto model = midbass();
    model = withLaw(model, "force-factor", b1, b2);
    model = withLaw(model, "stiffness", k1, k2);
    model = withLaw(model, "inductance-position", l1, l2);
    const auto expanded = expand(model, Quantity::current);
    REQUIRE(expanded.isValid());
    const auto linear = smallSignal(model);
    // The loops of Le(x) follow the current and, without weight, move nothing.
    const auto& A = expanded.form.linear.A;
    CHECK((A.topLeftCorner<3, 3>() - linear.A.topLeftCorner<3, 3>()).norm()
          < 1e-5 * linear.A.topLeftCorner<3, 3>().norm());
    CHECK(A.topRightCorner(3, A.cols() - 3).norm() < 1e-9 * linear.A.norm());
    CHECK((expanded.form.linear.B.col(0).head<3>() - linear.B.head<3>()).norm() < 1e-5 * linear.B.norm());

    const auto near = [&](Index row, const Eigen::RowVector4i& exponents, double expected) {
        CAPTURE(row, exponents, expected, coefficient(expanded, row, exponents));
        CHECK(coefficient(expanded, row, exponents) == Approx(expected).epsilon(1e-3));
    };
    // m v' = (Bl + b1 x + b2 x^2) i - (K + k1 x + k2 x^2) x - r v + (l1 + 2 l2 x) i^2 / 2
    near(2, {1, 1, 0, 0}, b1 / m);
    near(2, {1, 2, 0, 0}, b2 / m);
    near(2, {0, 2, 0, 0}, -k1 / m);
    near(2, {0, 3, 0, 0}, -k2 / m);
    near(2, {2, 0, 0, 0}, 0.5 * l1 / m);
    near(2, {2, 1, 0, 0}, l2 / m);
    // (L + l1 x + ..) i' = u - R i - (Bl + b1 x + ..) v - (l1 + 2 l2 x) i v
    near(0, {0, 1, 0, 1}, -l1 / (L * L));
    near(0, {1, 1, 0, 0}, R * l1 / (L * L));
    near(0, {0, 1, 1, 0}, -b1 / L + Bl * l1 / (L * L));
    near(0, {1, 0, 1, 0}, -l1 / L);
    near(0, {0, 2, 0, 1}, l1 * l1 / (L * L * L) - l2 / (L * L));
    near(0, {1, 1, 1, 0}, -2.0 * l2 / L + l1 * l1 / (L * L));
    CHECK(coefficient(expanded, 1, {0, 2, 0, 0}) == 0.0);

    CHECK_THROWS_AS(expand(model, Quantity::pressure), Error);
    CHECK_THROWS_AS(expand(model, Quantity::current, {.degree = 0}), Error);
    CHECK_THROWS_AS(expand(model, Quantity::current, {.degree = 3, .reach = 2.0}), Error);
}

TEST_CASE(
    "A driver's expansion moves as the driver does, the closer the less it is driven, with memories and any output",
    "[slow]")
{
    const double rate = 48000.0;
    const auto errorOf = [&](const Model& model, const FractionalPnlss& expanded, Quantity output, double amplitude) {
        const auto u = burst(rate, amplitude);
        const auto driver = simulate(model, u, rate, {1e-7, 64});
        const auto& y = driver.find(output)->samples;
        const Eigen::Map<const Eigen::VectorXd> truth(y.data(), static_cast<Index>(y.size())),
            input(u.data(), static_cast<Index>(u.size()));
        return (simulate(expanded, input, FractionalGrid {rate, 4, {}}) - truth).norm() / truth.norm();
    };
    for (const auto* effect : catalogue()) {
        if (!effect->felt())
            continue;  // it moves nothing, but the spot that the laser sees
        CAPTURE(effect->id());
        const auto model = withStrong(midbass(), *effect);
        for (const auto output : {Quantity::current, Quantity::acceleration}) {
            CAPTURE(name(output));
            const auto expanded = expand(model, output);
            // A resistance that grows like |v| has no Taylor expansion to speak of; over all that is visited the best
            // polynomial is nearer.
            if (effect->law() && effect->law()->argument == "v") {
                const double best = errorOf(model, expand(model, output, {.degree = 3, .reach = 1.0}), output, 10.0);
                CAPTURE(best);
                CHECK(best < 0.03);
                CHECK_FALSE(errorOf(model, expanded, output, 10.0) < 2.0 * best);  // Taylor's runs away
                continue;
            }
            // Nor has a hysteresis, which turns with the sign of v however small the motion.
            if (effect->id() == "friction") {
                CHECK_FALSE(errorOf(model, expanded, output, 0.5) < 0.05);
                continue;
            }
            // What is left is of the fourth degree: of the third relative to the output.
            const double loud = errorOf(model, expanded, output, 1.0), quiet = errorOf(model, expanded, output, 0.5);
            CAPTURE(loud, quiet);
            CHECK(loud < 1e-3);
            CHECK((quiet < 0.3 * loud || quiet < 2e-5));
        }
    }
}

TEST_CASE("A discretized expansion comes closer to the continuous one the faster it steps, and can be handed to a fit")
{
    auto model = midbass();
    for (const auto* effect : catalogue())
        if (!effect->linear())
            model = withStrong(model, *effect);
    const auto expanded = expand(model, Quantity::current);
    std::vector<double> errors;
    for (const double rate : {48000.0, 96000.0, 192000.0}) {
        const auto u = burst(48000.0, 1.0);
        std::vector<double> held;
        for (const double value : u)
            // the input itself stays the same
            held.insert(held.end(), static_cast<std::size_t>(rate / 48000.0), value);
        const Eigen::Map<const Eigen::VectorXd> input(held.data(), static_cast<Index>(held.size()));
        const auto discrete = discretized(expanded, rate);
        REQUIRE(discrete.isValid());
        const auto fine = discretized(expanded, 8.0 * rate);
        std::vector<double> finer;
        for (const double value : held)
            finer.insert(finer.end(), 8, value);
        const Eigen::Map<const Eigen::VectorXd> fineHeld(finer.data(), static_cast<Index>(finer.size()));
        const auto y = simulate(discrete, input), z = simulate(fine, fineHeld);
        double error = 0.0, power = 0.0;
        for (Index t = 0; t < y.rows(); ++t) {
            error += std::pow(y(t, 0) - z(8 * t, 0), 2);
            power += std::pow(z(8 * t, 0), 2);
        }
        errors.push_back(std::sqrt(error / power));
    }
    CAPTURE(errors);
    CHECK(errors[0] < 1e-2);
    CHECK(errors[1] / errors[0] == Approx(0.5).epsilon(0.2));
    CHECK(errors[2] / errors[1] == Approx(0.5).epsilon(0.2));
}
