// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/BlackBox.h"

namespace excursion {

/// Where the records of a fit have been, as an ellipsoid around their mean in what the nonlinearity sees, s = (z, u):
///     |W (s - centre)| <= 1
/// with W from their covariance, scaled so that all of them lie inside. Polynomials are right nowhere else, and grow
/// without bounds: outside, they are taken at the place of the ellipsoid that lies on the way to its centre, so that
/// what they add is bounded, and with it the output of a model whose linear part is stable.
struct Region {
    Eigen::VectorXd centre;  ///< seen + 1
    Eigen::MatrixXd W;       ///< square
    double output = 0.0;     ///< rms of the model's output there, without its mean
    double farthest = 0.0;   ///< the largest output there, from that at rest

    double distance(const Eigen::VectorXd& place) const { return (W * (place - centre)).norm(); }
};

/// The model's rest under silence: its states and q, which constants among the monomials move away from zero.
struct Rest {
    Eigen::VectorXd x, q;
};

/// Throws Error (data) for a model that does not come to rest.
Rest restOf(const BlackBox&);

/// Of the model that plays its stimulus, as multisines of random phases. Throws Error (data) where it runs away.
Region visitedBy(const BlackBox&);

/// The output, one a sample, for an input from rest, without any bound.
Eigen::VectorXd simulate(const BlackBox&, const Eigen::VectorXd& input);

}  // namespace excursion
