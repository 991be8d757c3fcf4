// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace excursion {

/// The real modes of dz/dt = A z: z = basis y, where y falls into pairs, dy/dt = [re im; -im re] y, first, and single
/// states.
struct Modes {
    Eigen::MatrixXd basis, inverse;  ///< inverse: of the basis
    Eigen::Index pairs = 0;
    bool apart = false;  ///< the change to them costs no more than six digits; else nothing of this is of use
};

Modes modesOf(const Eigen::MatrixXd& A);

}  // namespace excursion
