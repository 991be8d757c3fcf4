// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <Eigen/Core>

#include <functional>

namespace excursion {

/// Standard errors of numbers that follow from a model, sqrt(diag(J C J^T)): J by central differences over a small
/// share of each parameter's standard error, C the model's covariance. NaN where that is unknown, and where a number
/// follows from a parameter whose error is.
Eigen::VectorXd standardErrorsOf(const Model&, const std::function<Eigen::VectorXd(const Model&)>& numbers);

}  // namespace excursion
