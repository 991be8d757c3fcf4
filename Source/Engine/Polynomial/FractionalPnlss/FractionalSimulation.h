// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/FractionalPnlss/FractionalPnlss.h"

namespace excursion {

/// An input at samples, between them and `after` samples beyond, band-limited: (N substeps) x m.
/// @param periodic  the samples after `skip` are one whole period, which goes on; else the record is continued by
/// reflection
Eigen::MatrixXd fineInput(const Eigen::MatrixXd& input, int substeps, bool periodic, Eigen::Index skip);

/// The output, N x p, from rest, for an input of N samples, N x m, at the grid's sample rate: between samples it is
/// interpolated band-limited. A model that runs away leaves the finite numbers. Throws Error (usage) where the input
/// does not fit.
Eigen::MatrixXd simulate(const FractionalPnlss&, const Eigen::MatrixXd& input, const FractionalGrid&);

}  // namespace excursion
