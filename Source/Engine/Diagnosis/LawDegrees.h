// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/RaiseDegrees.h"
#include "Engine/Diagnosis/Score.h"
#include "Engine/Loudspeaker/Fit.h"

#include <optional>
#include <vector>

namespace excursion {

/// Expands laws as far as their coefficients pay, with a fit after each step. The last fit, if there was one.
/// @param score  with the residuals that the fits minimize
/// @param share  of the cost by which each must also lower it
std::optional<FitSummary> raiseAsItPays(Model&, const Record&, const std::vector<std::size_t>& sections,
                                        const FitOptions&, const ScoreOptions& score, double share,
                                        const Progress& = {});

/// Whether laws of a higher degree leave more of the sections that no fit saw than their price, or run away there: a
/// polynomial may go anywhere between and beyond the places that its fit has visited.
bool speaksAgainst(const Model& higher, const Model& lower, const Record&, const FitOptions&);

/// Law k without its highest coefficients theta_b, as many as a raise brings, and the other parameters theta_r where
/// the inverse curvature C of the last fit has the least cost then:
///     theta_r <- theta_r - F theta_b,   C_rr <- C_rr - F C_br,   F = C_rb C_bb^-1,
/// and its covariance S becomes that of this estimate,
///     S_rr <- S_rr - F S_br - S_rb F^T + F S_bb F^T.
/// No fit is needed: near its minimum the cost is a parabola. The model has the covariance of its fit, and the law more
/// than `by` degrees.
Model withLowerLaw(const Model&, std::size_t k, int by = degreesAtOnce);

/// Takes back what laws were raised by, where that no longer pays: at once, by the covariance of the fit by simulation
/// whose summary is given, whose cost follows. Each is checked by a simulation: where that leaves more than
/// the parabola says, the law stays as it is.
void lowerAsItPays(Model&, FitSummary&, const Record&, const std::vector<std::size_t>& sections, FitOptions);

/// Lowers laws further in the same way where sections that no fit saw are left with more than those that were fitted,
/// or the model runs away there, as long as both together are left with less.
void lowerAsUnseenTells(Model&, FitSummary&, const Record&, const std::vector<std::size_t>& sections, FitOptions,
                        const Progress& = {});

}  // namespace excursion
