// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/Modes.h"

#include "Engine/Numerics/Eigenvalues.h"
#include "Engine/Numerics/StateUnits.h"
#include "Engine/Numerics/ThinSvd.h"

#include <Eigen/LU>

namespace excursion {

Modes modesOf(const Eigen::MatrixXd& A)
{
    constexpr double worstCondition = 1e6;
    const auto units = stateUnits(A);  // so that the condition does not hang on units
    const auto found = eigenvectors(inUnits(A, units));
    const auto n = A.rows();
    Eigen::MatrixXd vectors(n, n);
    Modes modes;
    Eigen::Index column = 0;
    for (const bool complex : {true, false}) {
        for (Eigen::Index k = 0; k < n; ++k) {
            const double turn = found.values[k].imag();
            const Eigen::VectorXcd vector = found.vectors.col(k);
            if (complex && turn > 0.0) {
                vectors.col(column++) = vector.real();
                vectors.col(column++) = vector.imag();
            } else if (!complex && turn == 0.0) {
                vectors.col(column++) = vector.real();
            }
        }
        if (complex)
            modes.pairs = column / 2;
    }
    const auto singular = singularValues(vectors);
    modes.apart = singular[0] < worstCondition * singular[n - 1];
    modes.basis = units.asDiagonal() * vectors;
    if (modes.apart)
        modes.inverse = Eigen::FullPivLU<Eigen::MatrixXd>(vectors).inverse() * units.cwiseInverse().asDiagonal();
    return modes;
}

}  // namespace excursion
