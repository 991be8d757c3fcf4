// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/StateSpace.h"

#include <Eigen/Core>

#include <complex>
#include <vector>

namespace excursion {

/// The poles of a model with one input as quadratic and linear factors, and the partial fractions over them that carry
/// its response:
///     G(lambda) = D + sum_i (c_1i + c_2i (mu + b_i/2)) / (mu^2 + b_i mu + e_i)  [+ c / (mu + a)],
///         mu = lambda / scale
/// with lambda = z - 1, s or, of fractional order, s^alpha (see Response.h). Real pairs and complex pairs pass into one
/// another smoothly, and poles far apart do not disturb each other's digits as the coefficients of one long polynomial
/// would.
struct SecondOrderSections {
    Eigen::VectorXd factors;  ///< b_1, e_1, b_2, e_2, ..; then a when the order is odd
    double sampleRate = 0.0;  ///< Hz; 0: continuous time
    double scale = 1.0;       ///< rad/s (to the power alpha) in continuous time, else 1
    double alpha = 1.0;       ///< order of differentiation, between 0 and 2; 1 in discrete time
    /// 0 to 3: coefficients are fitted so that G falls as lambda^-relativeDegree at least, see RelativeDegree.h
    int relativeDegree = 0;

    Eigen::Index order() const { return factors.size(); }
    Eigen::Index pairs() const { return factors.size() / 2; }
    bool odd() const { return factors.size() % 2 != 0; }
};

/// @param poles  closed under conjugation (the imaginary part of a lone one is dropped)
SecondOrderSections sectionsOf(const std::vector<std::complex<double>>& poles, double sampleRate, double scale,
                               double alpha = 1.0);

/// The factors' roots, as poles of the model: z, s or s^alpha.
std::vector<std::complex<double>> poles(const SecondOrderSections&);

/// All roots within the stable region: the unit circle, the left half-plane, or outside of the sector |arg| <= alpha
/// pi/2 (Matignon 1996) [B 5.18].
bool isStable(const SecondOrderSections&);

/// Unstable roots mirrored: 1/conj(z), -conj(s), or at the border of the sector, but no further than the middle of what
/// lies beyond it; real ones to the negative axis.
SecondOrderSections mirrored(const SecondOrderSections&);

/// The basis functions at points lambda, K x n: 1/q_i and (mu + b_i/2)/q_i for each pair, then 1/(mu + a).
Eigen::MatrixXcd partialFractions(const SecondOrderSections&, const Eigen::VectorXcd& lambda);

/// sum_j c_j d(basis_j)/d(factor), one column a factor, given the partial fractions at the same points.
Eigen::MatrixXcd partialFractionSlopes(const SecondOrderSections&, const Eigen::VectorXcd& lambda,
                                       const Eigen::MatrixXcd& basis, const Eigen::VectorXd& c);

/// The model with these poles. @param C  p x n, coefficients of the partial fractions; @param D  p x 1
/// Complex pairs become rotations [r, -w; w, r], B and C of a state equally long.
StateSpace realize(const SecondOrderSections&, const Eigen::MatrixXd& C, const Eigen::VectorXd& D);

}  // namespace excursion
