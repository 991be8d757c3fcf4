// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace excursion {

/// The real modes of dz/dt = A z: z = basis y, where y consists of pairs, dy/dt = [re im; -im re] y, followed by single
/// states.
struct Modes {
    Eigen::MatrixXd basis, inverse;  ///< inverse: of the basis
    Eigen::Index pairs = 0;
    bool apart = false;  ///< the change of basis costs no more than six digits; if false, do not use the modes
};

Modes modesOf(const Eigen::MatrixXd& A);

}  // namespace excursion
