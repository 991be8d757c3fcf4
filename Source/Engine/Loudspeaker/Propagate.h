// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <Eigen/Core>

#include <functional>

namespace excursion {

/// Standard errors of numbers derived from a model, sqrt(diag(J C J^T)): J by central differences over a small fraction
/// of each parameter's standard error, C its widenedCovariance(). NaN if C is unknown, or if a number depends on a
/// parameter whose error is unknown.
Eigen::VectorXd standardErrorsOf(const Model&, const std::function<Eigen::VectorXd(const Model&)>& numbers);

}  // namespace excursion
