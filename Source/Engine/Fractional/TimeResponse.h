// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Fractional/FractionalStateSpace.h"
#include "Engine/Numerics/DiffusiveLadder.h"

namespace excursion {

/// Responses in time of a fractional model, at rest before t = 0.

/// The response to a unit step, exact up to rounding: from [B theorem 1, 5.11, 5.13], integrated,
///     y(t) = C t^alpha E_{alpha,alpha+1}(A t^alpha) B + D,
/// the function of A by its eigenvectors. One p x m matrix a time (s, at least 0).
/// Throws Error (numerical) when A has not enough eigenvectors for that.
std::vector<Eigen::MatrixXd> stepResponse(const FractionalStateSpace&, const std::vector<double>& times);

/// The response to an impulse, without what D passes of it: C t^(alpha-1) E_{alpha,alpha}(A t^alpha) B; times above 0.
std::vector<Eigen::MatrixXd> impulseResponse(const FractionalStateSpace&, const std::vector<double>& times);

/// The model with its fractional integrators replaced by ladders, an ordinary model of continuous time: x = s^-alpha v,
/// v = A x + B u, with
///     s^-alpha = s^(a-1), a = 1 - alpha, below 1, and (1/s) s^(a-1), a = 2 - alpha, above.
/// It has n (cells + 1) states, n more above 1, and at any frequency the response of the fractional model with lambda
/// off by the ladder's error. It keeps what is stable in reach of the band; alpha = 1 is passed as it is.
/// @param band  should reach from below 1/(duration) to beyond the rates that matter
StateSpace expanded(const FractionalStateSpace&, const DiffusiveLadderOptions& band);

/// Simulations at a sample rate; input N x m, output N x p.

/// By the expanded model, its response to a line between samples exact.
Eigen::MatrixXd simulateByLadder(const FractionalStateSpace&, const Eigen::MatrixXd& input, double sampleRate,
                                 const DiffusiveLadderOptions& band);

/// By Gruenwald and Letnikov's difference, all of the past remembered: (T^-alpha I - A) x_n = B u_n - T^-alpha
/// sum_{j>=1} w_j x_{n-j}. Error of order T, time of order N^2: a reference that shares nothing with the others.
Eigen::MatrixXd simulateByDifference(const FractionalStateSpace&, const Eigen::MatrixXd& input, double sampleRate);

}  // namespace excursion
