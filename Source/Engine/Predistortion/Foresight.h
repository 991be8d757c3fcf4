// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/Bands.h"
#include "Engine/Predistortion/LinearMotion.h"

#include <Eigen/Core>

namespace excursion {

/// The future positions of a linear cone, on a grid of times. It coasts from its state, and is driven by an input that
/// is constant on each step,
///     x(t_i) = c exp(A t_i) z + sum_k h_ik p_k,   h_ik = the integral of c exp(A (t_i - s)) B over the part of step k
///         before t_i and after now.
struct Foresight {
    Eigen::MatrixXd coasting;  ///< times x state, m
    Eigen::MatrixXd driven;    ///< times x steps, m/V

    /// @param basis      the state of the motion per state that is foreseen from, see Reference::basis()
    /// @param times      s, ascending
    /// @param steps      number of steps from now on
    /// @param step       s, length of each
    /// @param since      s, how long before now the first step began; less than a step
    Foresight(const LinearMotion&, const Eigen::MatrixXd& basis, const Eigen::VectorXd& times, Eigen::Index steps,
              double step, double since);

    /// Inputs that are held reach a cone weaker than the curve through them, by (w T)^2/24 at most: this makes up for
    /// it. Before the first step is what is not known, and after the last one silence.
    void sharpen();
};

/// The largest factors of three parts with which |rest + sum_b factor_b part_b| stays within the limit at every time.
/// The first part is turned down completely before the second is touched, and the last part is kept longest.
/// @param rest   m; the factors are zero where even silence does not keep the limit
/// @param parts  times x bands, m
/// @param most   upper limits of the factors
Bands::Values largestWithin(const Eigen::VectorXd& rest, const Eigen::MatrixXd& parts, Bands::Values most,
                            double limit);

}  // namespace excursion
