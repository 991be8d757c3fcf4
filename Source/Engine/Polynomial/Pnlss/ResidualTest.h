// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/Pnlss/Pnlss.h"
#include "Engine/Polynomial/PnlssRecord.h"

#include <optional>

namespace excursion {

/// Whether what a model leaves of a record is noise, or follows from the input: noise is what nothing made of the input
/// can tell.
///
/// The residual e is whitened by an autoregressive filter A of its own (Burg 1975), A e regressed on the states, the
/// input and their monomials at a few lags, and both parts of it, told and untold, are taken back through 1/A. So the
/// colour of the noise does not matter, and a residual of slow motion counts with all of its power. What chance tells,
/// the share of regressors in the samples, is taken off. The untold part is an estimate of the noise, from above.
/// The test sees what such regressors see: a residual that follows from the input by a memory much longer than their
/// lags, or by a bend that no polynomial shows, may pass for noise.
/// @return  power of the noise, dB of the output (seed 4.26); empty where the model runs away or the record has too few
/// samples
std::optional<double> untoldDb(const Pnlss&, const PnlssRecord&, const Eigen::VectorXd& initial);

/// The same of several records together; initial states where there are any.
std::optional<double> untoldDb(const Pnlss&, const std::vector<PnlssRecord>&,
                               const std::vector<Eigen::VectorXd>& initial);

/// An error is at the noise when it is no more than this above it.
constexpr double atNoiseDb = 3.0;

/// No recorded signal resolves an error below this, nor need a fit go further.
constexpr double exactDb = -120.0;

}  // namespace excursion
