// SPDX-License-Identifier: GPL-3.0-or-later
// What the fits stand on: orthogonal powers, partial fractions.
#include "Engine/Numerics/OrthogonalPowers.h"
#include "Linear/Problem.h"

#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Complex = std::complex<double>;

TEST_CASE("Powers are orthonormal far past where plain powers break down, and obey their recurrence")
{
    const Eigen::Index K = 300, q = 120;
    Eigen::VectorXcd z(K);
    Eigen::VectorXd w(K);
    for (Eigen::Index k = 0; k < K; ++k) {  // an arc, not a circle
        z[k] = std::polar(1.0, 0.2 + 1.3 * static_cast<double>(k) / static_cast<double>(K));
        w[k] = 1.0 + 0.5 * std::sin(static_cast<double>(k));
    }
    const auto basis = orthogonalPowers(z, w, q);
    REQUIRE(basis.values.cols() == q);
    const Eigen::MatrixXd gram = (basis.values.adjoint() * basis.values).real();
    CHECK((gram - Eigen::MatrixXd::Identity(q, q)).cwiseAbs().maxCoeff() < 1e-13);
    const Eigen::MatrixXcd left = z.asDiagonal() * basis.values.leftCols(q - 1);
    CHECK((left - basis.values * basis.H.topLeftCorner(q, q - 1)).cwiseAbs().maxCoeff() < 1e-13);
    // three points carry six real polynomials
    CHECK(orthogonalPowers(z.head(3), w.head(3), 20).values.cols() == 6);
}
