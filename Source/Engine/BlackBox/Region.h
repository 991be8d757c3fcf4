// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/BlackBox.h"

namespace excursion {

/// The range of a fit's records, as an ellipsoid around their mean in the quantities that the nonlinearity sees, s =
/// (z, u):
///     |W (s - centre)| <= 1
/// with W from their covariance, scaled so that all of them lie inside. Outside, the polynomials are not valid and grow
/// without bound. There, they are evaluated at the point of the ellipsoid on the line to its centre. So their
/// contribution is bounded, and with it the output of a model whose linear part is stable.
struct Region {
    Eigen::VectorXd centre;  ///< seen + 1
    Eigen::MatrixXd W;       ///< square
    double output = 0.0;     ///< rms of the model's output there, without its mean
    double farthest = 0.0;   ///< the largest output there, relative to that at rest

    double distance(const Eigen::VectorXd& place) const { return (W * (place - centre)).norm(); }
};

/// The model's rest under silence: its states and q. Constants among the monomials make them nonzero.
struct Rest {
    Eigen::VectorXd x, q;
};

/// Throws Error (data) for a model that does not come to rest.
Rest restOf(const BlackBox&);

/// The region of the model when it plays its stimulus, as random-phase multisines. Throws Error (data) if it runs away.
Region visitedBy(const BlackBox&);

/// The output, one value per sample, for an input from rest, without any bound.
Eigen::VectorXd simulate(const BlackBox&, const Eigen::VectorXd& input);

}  // namespace excursion
