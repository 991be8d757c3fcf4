// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace excursion {

/// Complex equations as real ones: real parts above imaginary parts, each line times its weight.
/// @param rows     2 K rows; columns from `first` on are written
/// @param columns  K lines
/// @param weights  K
inline void placeRealRows(Eigen::MatrixXd& rows, Eigen::Index first, const Eigen::MatrixXcd& columns,
                          const Eigen::VectorXd& weights)
{
    const auto K = columns.rows();
    rows.block(0, first, K, columns.cols()) = weights.asDiagonal() * columns.real();
    rows.block(K, first, K, columns.cols()) = weights.asDiagonal() * columns.imag();
}

}  // namespace excursion
