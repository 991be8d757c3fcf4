// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Effect.h"
#include "Engine/Numerics/NormalEquations.h"

#include <Eigen/Core>

#include <vector>

namespace excursion {

/// What a search moves: parameters p, and of even ones (Parameter::even) the square q = p^2. The slope by p vanishes at
/// p = 0, and a step that follows from it is out of all reason; that by q = p^2,
///     dr/dq = (dr/dp)/(2 p),
/// is as good there as anywhere. So that it is known, an even parameter stays a little away from 0 (leaveZero).
class SearchCoordinates {
public:
    /// @param parameters  they outlive this
    explicit SearchCoordinates(std::vector<Parameter*> parameters);

    Eigen::VectorXd now() const;
    Eigen::VectorXd lower() const;
    Eigen::VectorXd upper() const;
    void place(const Eigen::VectorXd& at);

    /// dp/dq where the parameters are, 1 where they are their own coordinates.
    Eigen::VectorXd slopes() const;
    /// Normal equations by parameters, with their priors (addPrior), become those by coordinates. A prior is linear in
    /// a square: it has no curvature there.
    /// @param variance  of the prior
    void convert(NormalEquations&, double variance) const;

private:
    std::vector<Parameter*> parameters_;
};

/// Moves an even parameter to a thousandth of its prior if it is nearer to 0; others stay.
void leaveZero(Parameter&);

}  // namespace excursion
