// SPDX-License-Identifier: GPL-3.0-or-later
// Exponentials against closed forms.
#include "Engine/Numerics/Exponential.h"
#include "Engine/Numerics/StateUnits.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace excursion;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

double factorial(int k) { return std::tgamma(k + 1.0); }

/// phi_k(z) = (phi_{k-1}(z) - 1/(k-1)!)/z, phi_0 = exp; its series near zero, where the recursion cancels.
double phi(int k, double z)
{
    if (std::abs(z) < 1.0) {
        double sum = 0.0;
        for (int j = 25; j >= 0; --j)
            sum = sum * z + 1.0 / factorial(j + k);
        return sum;
    }
    return k == 0 ? std::exp(z) : (phi(k - 1, z) - 1.0 / factorial(k - 1)) / z;
}

}  // namespace

TEST_CASE("The exponential of a scalar and its integrals are those of the textbook", "[exponential]")
{
    for (const double rate : {-3.0, -0.02, 0.0, 1e-9, 0.7, 40.0}) {
        constexpr double h = 0.25;
        const auto found = exponential(MatrixXd::Constant(1, 1, rate), MatrixXd::Constant(1, 1, 5.0), h, 4);
        CAPTURE(rate);
        CHECK(found.decay(0, 0) == Approx(std::exp(rate * h)).epsilon(1e-14));
        REQUIRE(found.phi.cols() == 4);
        for (int k = 1; k <= 4; ++k)
            CHECK(found.phi(0, k - 1) == Approx(5.0 * h * phi(k, rate * h)).epsilon(1e-12));
    }
}

TEST_CASE("A turning state turns, a chain of integrators integrates, and inputs do not mix", "[exponential]")
{
    constexpr double w = 30.0, h = 0.01;
    MatrixXd A(2, 2);
    A << 0.0, -w, w, 0.0;
    const auto turn = exponential(A, MatrixXd::Identity(2, 2), h, 1);
    MatrixXd R(2, 2), integral(2, 2);
    R << std::cos(w * h), -std::sin(w * h), std::sin(w * h), std::cos(w * h);
    integral << std::sin(w * h) / w, (std::cos(w * h) - 1.0) / w, (1.0 - std::cos(w * h)) / w, std::sin(w * h) / w;
    CHECK((turn.decay - R).norm() < 1e-15);
    CHECK((turn.phi - integral).norm() < 1e-16);

    // x1' = x2, x2' = x3, x3' = u: h^k/k! everywhere.
    constexpr double step = 0.5;
    MatrixXd N = MatrixXd::Zero(3, 3);
    N.topRightCorner(2, 2).setIdentity();
    const auto moved = exponential(N, VectorXd::Unit(3, 2), step, 3);
    for (Index row = 0; row < 3; ++row) {
        for (Index column = row; column < 3; ++column) {
            const int k = static_cast<int>(column - row);
            CHECK(moved.decay(row, column) == Approx(std::pow(step, k) / factorial(k)).epsilon(1e-14));
        }
        for (int order = 1; order <= 3; ++order) {  // the input (t/step)^(order-1)/(order-1)!
            const int k = static_cast<int>(2 - row) + order;
            CHECK(moved.phi(row, order - 1)
                  == Approx(std::pow(step, 3 - static_cast<double>(row)) / factorial(k)).epsilon(1e-14));
        }
    }

    // Several inputs at once are each of them alone; one that does nothing stays nothing.
    MatrixXd B = MatrixXd::Zero(3, 3);
    B.col(0) << 1.0, -2.0, 3.0;
    B.col(2) << 1e-9, 0.0, 1e-7;
    const auto together = exponential(N - 2.0 * MatrixXd::Identity(3, 3), B, step, 2);
    REQUIRE(together.phi.cols() == 6);
    for (Index q = 0; q < 3; ++q) {
        const auto alone = exponential(N - 2.0 * MatrixXd::Identity(3, 3), B.col(q), step, 2);
        for (Index k = 0; k < 2; ++k)
            CHECK((together.phi.col(3 * k + q) - alone.phi.col(k)).norm() <= 1e-14 * alone.phi.col(k).norm());
    }
    CHECK(together.phi.col(1).isZero(0.0));

    // No state, no memory.
    const auto none = exponential(MatrixXd(0, 0), MatrixXd(0, 2), step, 2);
    CHECK(none.decay.size() == 0);
    CHECK(none.phi.cols() == 4);
}

TEST_CASE("Units that lie twenty-four powers of ten apart cost no digit", "[exponential]")
{
    // dx/dt = -a x + c y, dy/dt = -b y + d u: c and d are but units.
    constexpr double a = 3.0, b = 7.0, h = 0.3;
    for (const double size : {1.0, 1e6, 1e12}) {
        const double c = size, d = 1.0 / size;
        MatrixXd A(2, 2);
        A << -a, c, 0.0, -b;
        const auto found = exponential(A, Eigen::Vector2d(0.0, d), h, 1);
        CAPTURE(size);
        CHECK(found.decay(0, 0) == Approx(std::exp(-a * h)).epsilon(1e-14));
        CHECK(found.decay(1, 1) == Approx(std::exp(-b * h)).epsilon(1e-14));
        CHECK(found.decay(0, 1) == Approx(c * (std::exp(-a * h) - std::exp(-b * h)) / (b - a)).epsilon(1e-13));
        CHECK(found.decay(1, 0) == 0.0);
        CHECK(found.phi(1, 0) == Approx(-d * std::expm1(-b * h) / b).epsilon(1e-13));
        const double x = c * d / (b - a) * (-std::expm1(-a * h) / a + std::expm1(-b * h) / b);
        CHECK(found.phi(0, 0) == Approx(x).epsilon(1e-12));
        const VectorXd units = stateUnits(A);
        CHECK(inUnits(A, units).cwiseAbs().maxCoeff() < 20.0);
    }
}

TEST_CASE("Four nodes of a step integrate a quadratic exactly", "[exponential]")
{
    // dx/dt = -k x + N(t), N = 1 + 2 t + 3 t^2: x(h) from rest by phi_1 .. phi_3.
    constexpr double k = 4.0, h = 0.2;
    const auto weights = quadrature(MatrixXd::Constant(1, 1, -k), VectorXd::Ones(1), h);
    const auto N = [](double t) { return 1.0 + 2.0 * t + 3.0 * t * t; };
    // The middle is given twice, so its weight counts for both.
    const double found = weights(0, 0) * N(0.0) + 2.0 * weights(0, 1) * N(0.5 * h) + weights(0, 2) * N(h);
    const double exact = h * (phi(1, -k * h) + 2.0 * h * phi(2, -k * h) + 6.0 * h * h * phi(3, -k * h));
    CHECK(found == Approx(exact).epsilon(1e-13));
}
