// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <vector>

namespace excursion::bench {

/// A memory of many first-order cells, driven by one signal g:
///     dz_k/dt = -rate_k z_k + g,   output = sum_k weight_k z_k,   H(s) = sum_k weight_k / (s + rate_k)
struct Relaxations {
    std::vector<double> rate;  ///< 1/s, positive
    std::vector<double> weight;

    std::complex<double> response(std::complex<double> s) const;
};

/// s^(-alpha), 0 < alpha < 1, by quadrature of its diffusive representation
///     s^(-alpha) = sin(pi alpha)/pi  integral_0^inf  r^(-alpha) / (s + r) dr.
/// Three panels: [0, low] by Gauss-Jacobi with weight r^(-alpha), [low, high] by Gauss-Legendre in
/// ln r, [high, inf) by Gauss-Jacobi in t = high/r with weight t^(alpha - 1). Each integrand is
/// analytic on its panel, so the convergence is geometric: with 6 + 26 + 6 cells the relative error stays
/// below 1e-6 for low <= |s| <= high over four and a half decades.
/// @param low, high  rad/s
Relaxations fractionalIntegral(double alpha, double low, double high);

/// ln((s + high)/(s + low)) = integral over ln r from low to high of r/(s + r): a flat spectrum of
/// relaxations (Ritter and Agerkvist's three-parameter creep; Knudsen and Jensen's logarithmic one,
/// 1 - lambda log10(s/s0), is its middle part). Gauss-Legendre in ln r.
Relaxations logarithm(double low, double high);

}  // namespace excursion::bench
