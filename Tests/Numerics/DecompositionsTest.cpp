// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/Eigenvalues.h"
#include "Engine/Numerics/LuFactors.h"
#include "Engine/Numerics/QrFactors.h"
#include "Engine/Numerics/Schur.h"
#include "Engine/Numerics/ThinSvd.h"

#include <Eigen/QR>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <numbers>

using namespace excursion;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

namespace {

using Complex = std::complex<double>;

/// 2 on the diagonal, -1 beside it: eigenvalues 2 - 2 cos(k pi / (n + 1)).
MatrixXd chain(Eigen::Index n)
{
    MatrixXd A = MatrixXd::Zero(n, n);
    A.diagonal().setConstant(2.0);
    A.diagonal(1).setConstant(-1.0);
    A.diagonal(-1).setConstant(-1.0);
    return A;
}

double chainValue(Eigen::Index k, Eigen::Index n)
{
    return 2.0 - 2.0 * std::cos(static_cast<double>(k) * std::numbers::pi / static_cast<double>(n + 1));
}

/// A pole at -3 and a pair at -1 +- 2j, in a companion form: (s + 3)(s^2 + 2 s + 5).
MatrixXd companion()
{
    MatrixXd A(3, 3);
    A << 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, -15.0, -11.0, -5.0;
    return A;
}

bool near(double a, double b) { return std::abs(a - b) < 1e-12; }

}  // namespace

TEST_CASE("Eigenvalues of a companion matrix are the roots of its polynomial", "[decompositions]")
{
    const auto values = eigenvalues(companion());
    REQUIRE(values.size() == 3);
    for (const Complex root : {Complex(-3.0, 0.0), Complex(-1.0, 2.0), Complex(-1.0, -2.0)})
        CHECK((values.array() - root).abs().minCoeff() < 1e-12);
    for (Eigen::Index k = 0; k < 3; ++k)
        if (values[k].imag() > 0.0)
            CHECK(values[k + 1] == std::conj(values[k]));
    CHECK(eigenvalues(MatrixXd(0, 0)).size() == 0);
}

TEST_CASE("Whether eigenvalues are within a radius is told on either side of it", "[decompositions]")
{
    const auto tells = [](const MatrixXd& A, double radius) {
        for (const double near : {1e-6, 1e-3, 0.3}) {
            CHECK(isWithin(A, radius * (1.0 + near)));
            CHECK_FALSE(isWithin(A, radius / (1.0 + near)));
        }
        CHECK(isWithin(A, 1e6 * radius));
        CHECK_FALSE(isWithin(A, 1e-6 * radius));
    };
    tells(companion(), 3.0);
    tells(chain(30), chainValue(30, 30));
    const VectorXd units = VectorXd::LinSpaced(30, -6.0, 6.0).unaryExpr([](double e) { return std::pow(10.0, e); });
    tells(units.asDiagonal() * chain(30) * units.cwiseInverse().asDiagonal(), chainValue(30, 30));
    MatrixXd turns = MatrixXd::Zero(4, 4);  // 2j and -2j, twice: a trace of 0, and the powers' turn
    turns(0, 1) = turns(2, 3) = 2.0;
    turns(1, 0) = turns(3, 2) = -2.0;
    tells(turns, 2.0);
    MatrixXd leads = MatrixXd::Zero(5, 5);  // one state leads to the next: powers vanish
    leads.diagonal(1).setConstant(100.0);
    CHECK(isWithin(leads, 1e-3));
    leads.diagonal().setConstant(0.9);  // and grow for long before they do
    CHECK(isWithin(leads, 0.95));
    CHECK_FALSE(isWithin(leads, 0.85));
    for (int seed = 0; seed < 20; ++seed) {  // so far from normal that the rounding errors of powers have a trace
        std::srand(static_cast<unsigned>(seed));
        const MatrixXd Q = Eigen::HouseholderQR<MatrixXd>(MatrixXd::Random(4, 4)).householderQ();
        MatrixXd T = MatrixXd::Zero(4, 4);
        T.diagonal() << 0.95, 0.7, -0.4, 0.1;
        T(0, 1) = 1e6;
        CHECK(isWithin(Q * T * Q.transpose(), 1.0));
    }
    CHECK(isWithin(MatrixXd(), 1.0));
    leads(0, 0) = std::nan("");
    CHECK_FALSE(isWithin(leads, 1e9));
}

TEST_CASE("Eigenvectors are those of powers, of length 1", "[decompositions]")
{
    const auto found = eigenvectors(companion());
    for (Eigen::Index k = 0; k < 3; ++k) {
        const Complex l = found.values[k];
        VectorXcd powers(3);
        powers << 1.0, l, l * l;
        powers.normalize();
        CHECK(near(std::abs(powers.dot(found.vectors.col(k))), 1.0));
        CHECK(near(found.vectors.col(k).norm(), 1.0));
    }
}

TEST_CASE("Eigenvalues of a symmetric chain ascend as its closed form, its eigenvectors are sines", "[decompositions]")
{
    constexpr Eigen::Index n = 7;
    const auto found = symmetricEigenvectors(chain(n));
    for (Eigen::Index k = 1; k <= n; ++k) {
        CHECK(near(found.values[k - 1], chainValue(k, n)));
        VectorXd sine(n);
        for (Eigen::Index i = 0; i < n; ++i)
            sine[i] = std::sin(static_cast<double>((i + 1) * k) * std::numbers::pi / static_cast<double>(n + 1));
        CHECK(near(std::abs(sine.normalized().dot(found.vectors.col(k - 1))), 1.0));
    }
}

TEST_CASE("Singular values of a symmetric matrix are the sizes of its eigenvalues", "[decompositions]")
{
    constexpr Eigen::Index n = 6;
    const auto s = singularValues(chain(n) - 2.0 * MatrixXd::Identity(n, n));  // +- 2 cos(k pi / (n + 1))
    REQUIRE(s.size() == n);
    for (Eigen::Index k = 0; k < n; ++k)
        CHECK(near(s[k], 2.0 * std::cos(static_cast<double>(k / 2 + 1) * std::numbers::pi / (n + 1.0))));
}

TEST_CASE("Schur forms are triangular, and turn back into their matrix", "[decompositions]")
{
    const auto A = companion();
    const auto real = realSchur(A);
    CHECK((real.U * real.T * real.U.transpose() - A).norm() < 1e-12);
    CHECK((real.U.transpose() * real.U - MatrixXd::Identity(3, 3)).norm() < 1e-13);
    CHECK(real.T(2, 0) == 0.0);
    CHECK((real.T(1, 0) == 0.0) != (real.T(2, 1) == 0.0));  // one block of two for the pair
    const auto complex = complexSchur(A);
    CHECK((complex.U * complex.T * complex.U.adjoint() - A.cast<Complex>()).norm() < 1e-12);
    CHECK((complex.U.adjoint() * complex.U - MatrixXcd::Identity(3, 3)).norm() < 1e-13);
    CHECK(complex.T.triangularView<Eigen::StrictlyLower>().toDenseMatrix().norm() == 0.0);
    for (const Complex root : {Complex(-3.0, 0.0), Complex(-1.0, 2.0), Complex(-1.0, -2.0)})
        CHECK((complex.T.diagonal().array() - root).abs().minCoeff() < 1e-12);
}

TEST_CASE("Triangular factors solve for vectors and matrices, and invert", "[decompositions]")
{
    constexpr Eigen::Index n = 5;
    RealLu lu(chain(n));
    // (A^-1)_ij = min(i, j) (n + 1 - max(i, j)) / (n + 1)
    MatrixXd inverse(n, n);
    for (Eigen::Index i = 1; i <= n; ++i)
        for (Eigen::Index j = 1; j <= n; ++j)
            inverse(i - 1, j - 1) = static_cast<double>(std::min(i, j) * (n + 1 - std::max(i, j))) / (n + 1.0);
    CHECK((lu.inverse() - inverse).norm() < 1e-13);
    CHECK((lu.solve(MatrixXd::Identity(n, n)) - inverse).norm() < 1e-13);
    CHECK((lu.solve(VectorXd::Unit(n, 2)) - inverse.col(2)).norm() < 1e-13);
    // The 1-norms are 4 and, of the middle column of the inverse, 4.5.
    CHECK(near(lu.rcond(), 1.0 / 18.0));
    lu.compute(2.0 * chain(n));
    CHECK((lu.inverse() - 0.5 * inverse).norm() < 1e-13);
    lu.compute(MatrixXd::Ones(n, n));
    CHECK_FALSE(lu.rcond() > 1e-15);

    const Complex j(0.0, 1.0);
    const ComplexLu complex(j * chain(n).cast<Complex>());
    CHECK((complex.solve(VectorXcd::Unit(n, 1)) + j * inverse.col(1)).norm() < 1e-13);
}

TEST_CASE("Least squares find the line through points, and what cannot be told stays short", "[decompositions]")
{
    // y = 1, 2, 2, 4 at x = 0, 1, 2, 3: slope 0.9, intercept 0.9
    MatrixXd A(4, 2);
    A << 1.0, 0.0, 1.0, 1.0, 1.0, 2.0, 1.0, 3.0;
    VectorXd y(4), line(2);
    y << 1.0, 2.0, 2.0, 4.0;
    line << 0.9, 0.9;
    MatrixXd both(4, 2), lines(2, 2);
    both << y, 2.0 * y;
    lines << line, 2.0 * line;
    const QrFactors factors(A);
    const MinimumNorm shortest(A);
    CHECK((factors.solveVector(y) - line).norm() < 1e-13);
    CHECK((factors.solve(both) - lines).norm() < 1e-13);
    CHECK((pivotedSolveVector(A, y) - line).norm() < 1e-13);
    CHECK((pivotedSolve(A, both) - lines).norm() < 1e-13);
    CHECK((shortest.solveVector(y) - line).norm() < 1e-13);
    CHECK((shortest.solve(both) - lines).norm() < 1e-13);
    CHECK((shortest.pseudoInverse() * y - line).norm() < 1e-13);
    CHECK(shortest.rank() == 2);

    MatrixXd twice(4, 3);
    twice << A, A.col(1);  // the slope is shared by two columns that are the same
    const MinimumNorm shared(twice);
    CHECK(shared.rank() == 2);
    CHECK((shared.solveVector(y) - VectorXd {{0.9, 0.45, 0.45}}).norm() < 1e-13);
}

TEST_CASE("A basis of what is spanned has as many columns as the matrix has rank", "[decompositions]")
{
    MatrixXd A(4, 3);
    A << 1.0, 0.0, 1.0, 1.0, 1.0, 2.0, 1.0, 2.0, 3.0, 1.0, 3.0, 4.0;  // the third is the sum of the others
    const auto Q = spannedBasis(A);
    REQUIRE(Q.rows() == 4);
    REQUIRE(Q.cols() == 2);
    CHECK((Q.transpose() * Q - MatrixXd::Identity(2, 2)).norm() < 1e-14);
    CHECK((A - Q * (Q.transpose() * A)).norm() < 1e-13);
}

TEST_CASE("A completed basis is orthonormal, and its first columns span the matrix", "[decompositions]")
{
    MatrixXd A(3, 1);
    A << 1.0, 2.0, 2.0;
    const auto Q = completedBasis(A);
    REQUIRE(Q.rows() == 3);
    REQUIRE(Q.cols() == 3);
    CHECK((Q.transpose() * Q - MatrixXd::Identity(3, 3)).norm() < 1e-14);
    CHECK(near(std::abs(Q.col(0).dot(A.col(0))), 3.0));
    CHECK((A.transpose() * Q.rightCols(2)).norm() < 1e-14);
}
