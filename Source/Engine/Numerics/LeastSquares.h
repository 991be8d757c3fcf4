// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Numerics/NormalEquations.h"
#include "Engine/Numerics/SearchSummary.h"
#include "Engine/Progress.h"

#include <Eigen/Core>

#include <functional>
#include <string>

namespace excursion {

struct LeastSquaresOptions {
    int maximumIterations = 30;  ///< steps that are taken
    /// stop when a step that is taken lowers the cost, without NormalEquations::sure, by less than this fraction
    double costTolerance = 1e-6;
    /// lambda of the first step, which solves (N + lambda diag N) d = -g. Along a valley whose floor is flatter than
    /// that, in units of the parameters' own errors, a step leads only part of the way.
    double firstDamping = 1e-3;

    bool isValid(std::string* reason = nullptr) const;
};

/// Fills the normal equations at theta, N and g only when `gradient`; returns false where the model cannot be evaluated
/// (a simulation that runs away); the search then shortens its step.
using NormalEvaluation = std::function<bool(const Eigen::VectorXd& theta, bool gradient, NormalEquations&)>;

/// J^T r with r of the place that was evaluated last and J of the place whose slopes were asked for last. Empty where
/// it is not known.
using ChordGradient = std::function<Eigen::VectorXd()>;

/// Where a step d from theta leads, theta + d to first order and within the bounds: along a known bend of the valley.
using Retraction = std::function<Eigen::VectorXd(const Eigen::VectorXd& theta, const Eigen::VectorXd& d)>;

/// Levenberg and Marquardt's search within bounds ([B 4.3.1]) on a problem that is only known through its normal
/// equations, so that long records never stand in memory as one Jacobian:
///     (N + D) d = -g,   D = lambda diag N + diag held,   theta + d within the bounds;
/// a parameter that a step would take out stops at its bound, and the step of the others is solved for again. The
/// damping lambda falls before each step and rises until one lowers the cost at all: slopes cost more than
/// steps, and in a curved valley the boldest step that goes down leads further than the one that goes down most. Where
/// the chord's gradient is known, a step that does not keep its promise is corrected with the slopes that are there
/// (a chord method), as long as that brings it down by half: parameters that the residuals hold fast follow those that
/// they hardly see round the bend of a valley, at the price of an evaluation without slopes,
///     (N + D) a = -(J^T r(theta + d) + D d),   d <- d + a.
/// Where there are no bounds and a triangular factor can be had, search() squares no condition number.
/// @param theta  start, then result; a start out of bounds is moved to them
/// @param retraction  theta + d unless given
/// @returns costs r^T r. Throws Error (usage) for options that make no sense, (cancelled) when progress says so.
SearchSummary minimize(const NormalEvaluation&, Eigen::VectorXd& theta, const Eigen::VectorXd& lower,
                       const Eigen::VectorXd& upper, const LeastSquaresOptions&, const Progress& = {},
                       const ChordGradient& = {}, const Retraction& = {});

}  // namespace excursion
