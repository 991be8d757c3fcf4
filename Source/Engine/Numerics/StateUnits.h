// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace excursion {

/// Units for the states of dz/dt = A z in which the rows and the columns of A are of one size: with D = diag(units),
/// D^-1 A D is balanced (Parlett & Reinsch 1969, Numer. Math. 13). In metres and amperes the entries of A may lie many
/// powers of ten apart, and as many digits are lost in its exponential, its eigenvalues and its factors. Powers of two,
/// so that to change units rounds nothing.
Eigen::VectorXd stateUnits(const Eigen::MatrixXd& A);

/// D^-1 A D.
Eigen::MatrixXd inUnits(const Eigen::MatrixXd& A, const Eigen::VectorXd& units);

}  // namespace excursion
