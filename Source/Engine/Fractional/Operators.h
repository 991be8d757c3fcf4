// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace excursion {

/// Integrals and derivatives of any order of sampled signals f(0), f(T), f(2T), .. that begin at t = 0 [B 5.1.1],
/// the whole past remembered. T is the interval in s; results have the unit of f times s^-alpha (of an integral
/// s^alpha). Each is a convolution, done by DFT in O(N log N).

/// Weights of the Gruenwald-Letnikov difference, w_j = (-1)^j binom(alpha, j):  w_0 = 1, w_j = (1 - (alpha + 1)/j)
/// w_{j-1}.
std::vector<double> gruenwaldWeights(double alpha, std::size_t count);

/// D^alpha f(nT) = T^-alpha sum_j w_j f((n - j)T): what is 0 before t = 0. Derivatives for alpha > 0, integrals below;
/// order of convergence 1 where f(0) = 0 and so on as smoothness asks. Throws Error (usage) unless |alpha| <= 10 and T
/// > 0.
std::vector<double> gruenwaldLetnikov(std::span<const double> f, double alpha, double interval);

/// The Riemann-Liouville integral J^alpha f [B eq. 5.1], alpha > 0: the kernel integrated exactly against the line
/// between samples (product trapezoidal rule; Diethelm, Ford & Freed 2004, Numer. Algorithms 36), order 2 for a smooth
/// f. Throws Error (usage) unless 0 < alpha <= 10 and T > 0.
std::vector<double> fractionalIntegral(std::span<const double> f, double alpha, double interval);

/// Caputo's derivative [B 5.6], J^(n-alpha) of the n-th derivative, n - 1 < alpha <= n, n = 1 or 2; the n-th
/// derivative by differences of second order, one-sided at the ends: order 2 where f has n + 2 continuous derivatives,
/// less where f behaves like t^p at 0 with p below. Throws Error (usage) unless 0 < alpha <= 2 and T > 0, (data) with
/// fewer than 4 samples.
std::vector<double> caputoDerivative(std::span<const double> f, double alpha, double interval);

/// The Riemann-Liouville derivative, the n-th derivative of J^(n-alpha) f ([B eq. 5.3] with q for alpha). It is
/// Caputo's and what the start values add,
///     sum_{k<n} f^(k)(0) t^(k-alpha) / Gamma(k + 1 - alpha),
/// infinite at t = 0 where f(0), for alpha > 1 also f'(0), is not exactly 0. Errors as above.
std::vector<double> riemannLiouvilleDerivative(std::span<const double> f, double alpha, double interval);

}  // namespace excursion
