// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Sums.h"

#include <string>
#include <vector>

namespace excursion {

/// The smallest reduction of the cost that justifies a new coefficient of a law, in units of the variance of the
/// residuals: twice the reduction by noise alone, about the 95 % point of chi-square. A higher price would leave a bias
/// of several standard errors out of the confidence bands. A lower one would let the law vary freely where the record
/// has little data.
inline constexpr double priceOfCoefficient = 2.4;

/// By how many degrees a law is raised at once, and lowered again where they do not pay.
inline constexpr int degreesAtOnce = 4;

/// Raises the degree of the model's laws by `by` if a score test justifies the new coefficients. Returns the effects
/// that were raised. The new coefficients start at zero.
/// @param share  of the cost by which each must also lower it
std::vector<std::string> raiseDegrees(Model&, const Record&, const ScoreOptions&, double share = 0.0,
                                      int by = degreesAtOnce, const Progress& = {});

/// Places in parameterVector() of what law k has by its `by` highest degrees.
std::vector<Eigen::Index> highestCoefficients(const Model&, std::size_t k, int by = degreesAtOnce);

/// What those coefficients theta are worth at the model's last fit, by their block C of its inverseCurvature():
///     theta^T C^-1 theta,
/// by which the cost would rise without them, in units of the residuals' variance; infinite where the fit tells none.
double worthOfHighest(const Model&, std::size_t k, int by = degreesAtOnce);

/// The laws whose highest coefficients, as many as a raise brings, are worth less than their price (worthOfHighest()),
/// as those of a law can be that was raised while another effect was missing. Numbers of components; none of a law of
/// the first degree, and none where the covariance is not known.
std::vector<std::size_t> tooHigh(const Model&, int by = degreesAtOnce);

}  // namespace excursion
