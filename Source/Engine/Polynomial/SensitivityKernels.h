// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include <array>

/// The arithmetic of a PNLSS model's Jacobian: plain loops over a block of time steps, or over eight parameters side by
/// side, compiled for any processor and for those with AVX2.
namespace excursion::kernels {

/// time steps of a block: M, G and the regressors stay in the nearest caches
inline constexpr Eigen::Index stretch = 256;
/// Between entries along time: no power of two, or they would compete for the same lines of the cache.
inline constexpr Eigen::Index pitch = stretch + 8;
inline constexpr Eigen::Index abreast = 8;  ///< parameters side by side

/// T steps for 8 parameters: J = G X, X <- M X + g r.
/// @param M, G    [entry][time], entries row by row, `pitch` apart
/// @param r, J    [time][parameter]; J of output o is at o * sizeJ
/// @param g       gain of r in each of the N states @param row  not negative: g is 1 there and 0 elsewhere
/// @param X       [state][parameter] @param next  scratch of the same size
void columnsThroughBlock(Eigen::Index N, const double* M, const double* G, Eigen::Index p, const double* r,
                         const double* g, Eigen::Index row, double* X, double* next, double* J, Eigen::Index sizeJ,
                         Eigen::Index T);

void multiply(double* target, const double* a, const double* b, Eigen::Index T);
void addScaled(double* target, double factor, const double* a, Eigen::Index T);

/// target = W r with W column after column, `rows` of them (a multiple of 4).
void combine(double* target, const double* W, const double* r, Eigen::Index rows, Eigen::Index count);

/// Eight columns, each contiguous along time, to rows of eight, and `count` of them back: a line of the cache at a
/// time.
void toRows(double* rows, const double* const* columns, Eigen::Index T);
void toColumns(double* columns, Eigen::Index columnStride, const double* rows, Eigen::Index count, Eigen::Index T);

/// The cells of a fractional integral (see FractionalIntegrator) and its past, for P parameters side by side: z_k <-
/// e_k z_k + sum_j b_kj v_j, held <- sum_k R_k e_k z_k + d_1 v_0 + d_2 v_1 + d_3 v_2. @param z  [cell][parameter]
/// @param weight  b, column after column @param v  newest first
void advance(double* z, Eigen::Index cells, Eigen::Index P, const double* decay, const double* weight,
             const std::array<const double*, 4>& v, const double* readout, const double* direct, double* held);

}  // namespace excursion::kernels
