// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/Bands.h"
#include "Engine/Predistortion/Reference.h"

#include <Eigen/Core>

namespace excursion {

/// Where a linear cone will be, at times of a grid ahead: it coasts from its state, and is driven by an input that is
/// constant on steps,
///     x(t_i) = c exp(A t_i) z + sum_k h_ik p_k,   h_ik = the integral of c exp(A (t_i - s)) B over the part of step k
///         before t_i and after now.
struct Foresight {
    Eigen::MatrixXd coasting;  ///< times x state of the Reference, m
    Eigen::MatrixXd driven;    ///< times x steps, m/V

    /// @param reference  whose states are asked with
    /// @param times      s, ascending
    /// @param steps      so many from now on
    /// @param step       s, of each
    /// @param since      s, by which the first of them began before now, less than a step
    Foresight(const LinearMotion&, const Reference& reference, const Eigen::VectorXd& times, Eigen::Index steps,
              double step, double since);
};

/// The largest factors of three parts, the last ones first to be kept, with which |rest + sum_b factor_b part_b| stays
/// within the limit at every time; the first part is given up before the second is touched.
/// @param rest   m; zero where even silence does not keep the limit
/// @param parts  times x bands, m
/// @param most   factors that are not to be passed
Bands::Values largestWithin(const Eigen::VectorXd& rest, const Eigen::MatrixXd& parts, Bands::Values most,
                            double limit);

}  // namespace excursion
