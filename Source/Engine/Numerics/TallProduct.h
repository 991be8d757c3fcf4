// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace excursion {

/// Rows are padded to a multiple of this, so that the product runs in whole vectors.
inline constexpr Eigen::Index tallBlock = 8;
inline Eigen::Index padded(Eigen::Index rows) { return (rows + tallBlock - 1) / tallBlock * tallBlock; }

/// Y += X W of matrices with a few dozen rows and few columns, thousands of times a second: too small for a blocked
/// product, whose packing takes longer than the product itself.
/// @param X    rows x inner by columns
/// @param W    inner x columns by columns
/// @param Y    rows x columns by columns; no part of it may lie in X
/// @param from, to  the rows that are wanted, from <= row < to; multiples of tallBlock, within rows
void addTallProduct(const double* X, Eigen::Index rows, Eigen::Index inner, const double* W, Eigen::Index columns,
                    double* Y, Eigen::Index from, Eigen::Index to);

}  // namespace excursion
