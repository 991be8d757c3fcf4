// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace excursion {

/// A matrix H that is multiplied often, laid out as the product reads it: some rows at a time, column by column, as far
/// as the last column that any of them has something in. A matrix that is zero above a staircase, such as a response to
/// inputs that come one after the other, costs little more than what is below it. The products allocate nothing.
class LaidRows {
public:
    LaidRows() = default;
    explicit LaidRows(const Eigen::MatrixXd& H);

    /// y = H x
    /// @param x  one value a column of H
    /// @param y  one value a row of H
    void multiply(const double* x, double* y) const;
    /// Y = H X for four at once, which takes little longer.
    /// @param X  four vectors x, one after the other; Y likewise
    void multiplyFour(const double* X, double* Y) const;

private:
    std::size_t rows_ = 0, columns_ = 0;
    std::vector<std::size_t> filled_;  ///< columns of each of these sets of rows
    std::vector<double> laid_;
};

}  // namespace excursion
