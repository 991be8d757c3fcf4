// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace excursion {

/// J^T J of a tall matrix, in the widest registers that the processor has.
Eigen::MatrixXd gram(const Eigen::MatrixXd& J);

}  // namespace excursion
