// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/Pnlss/Pnlss.h"
#include "Engine/Polynomial/InputOutputRecord.h"

#include <optional>
#include <vector>

namespace excursion {

/// What no model near this one would explain: the part of the residual e outside of the tangent of wider models.
///
/// The model is given monomials of up to two degrees more, in every row, at coefficients of zero, and the Jacobian J of
/// its simulation by all coefficients and first states. A force that the model lacks shows in J with the memory of its
/// own resonance, however slow that is beside a sample, which a regression on a few lags does not see.
struct OffTangent {
    double power = 0.0;  ///< min |e - J d|^2, summed over records and outputs
    double white = 0.0;  ///< share of itself that white noise would leave there, 1 - P / N
    /// the same of noise of the residual's own colour: of slow noise the P directions, as slow, take more
    double alike = 0.0;
};

/// @param initial  first states of the records; empty: zero
/// Empty where the model runs away, or the records have less than eight samples for a coefficient.
std::optional<OffTangent> offTangent(const Pnlss&, const std::vector<InputOutputRecord>&,
                                     const std::vector<Eigen::VectorXd>& initial);

}  // namespace excursion
