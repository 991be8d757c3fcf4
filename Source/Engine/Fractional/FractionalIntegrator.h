// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Numerics/DiffusiveLadder.h"

#include <complex>

namespace excursion {

/// The integral of fractional order on a grid of time, zeta = s^-alpha v, 0 < alpha <= 1, with a state of finite size:
/// the cells of a ladder (see DiffusiveLadder.h), each solved exactly for a v that runs along the cubic through its
/// last four values, the newest among them:
///     z_k(n) = e_k z_k(n-1) + sum_{j=0..3} b_kj v(n-j),     zeta(n) = sum_k R_k e_k z_k(n-1) + sum_j d_j v(n-j)
/// with e_k = exp(-p_k T) and d_j = sum_k R_k b_kj, to which cells faster than 40/T and the ladder's L add what they
/// pass at once. For alpha = 1 this is the implicit Adams-Moulton rule of fourth order. Its error is (19/720) (w T)^4,
/// relative, that of the ladder comes on top.
struct FractionalIntegrator {
    Eigen::VectorXd decay;                             ///< e_k
    Eigen::Matrix<double, Eigen::Dynamic, 4> weight;   ///< b_kj, s
    Eigen::VectorXd readout;                           ///< R_k, 1/s^(alpha - 1) a second
    Eigen::Vector4d direct = Eigen::Vector4d::Zero();  ///< d_j, s^alpha

    Eigen::Index cells() const { return decay.size(); }

    /// zeta over v at z = exp(j w T).
    std::complex<double> response(std::complex<double> z) const;
};

/// @param step  T, s @param band  of the ladder; not used for alpha = 1
/// Throws Error (usage) unless 0 < alpha <= 1 and T is above 0.
FractionalIntegrator integratorFor(double alpha, double step, const DiffusiveLadderOptions& band);

/// Its derivative by alpha, member by member, from central differences of closed forms (some nine digits). For 0 <
/// alpha < 1.
FractionalIntegrator integratorSlope(double alpha, double step, const DiffusiveLadderOptions& band);

}  // namespace excursion
