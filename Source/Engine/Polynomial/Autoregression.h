// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace excursion {

/// A signal as white noise through an all-pole filter, a(0) x(t) + a(1) x(t-1) + .. = e(t), a(0) = 1: Burg's method
/// (1975), the reflections that leave least of x going forth and back, so the filter 1/A is stable. Of order 0 .. N - 1
/// for N samples; a signal of zeros has a = 1, 0, 0, ..
Eigen::VectorXd autoregression(const Eigen::VectorXd& x, Eigen::Index order);

/// e of x, and x of e; samples before the first are 0.
Eigen::VectorXd whitenedBy(const Eigen::VectorXd& a, const Eigen::VectorXd& x);
Eigen::VectorXd colouredBy(const Eigen::VectorXd& a, const Eigen::VectorXd& e);

}  // namespace excursion
