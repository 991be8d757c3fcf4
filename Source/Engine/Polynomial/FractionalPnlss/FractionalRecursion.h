// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Fractional/FractionalIntegrator.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalPnlss.h"
#include "Engine/Polynomial/Pnlss/Recursion.h"

namespace excursion {

/// A fractional PNLSS model in time, and its derivatives: compiled once for a structure and a grid.
///
/// With the integrals of FractionalIntegrator, v = A zeta + B u + E p(zeta, u), and h what the past gives, every step
/// solves
///     zeta = h + diag(d_0) v(zeta, u)
/// by Newton's method. The sensitivities obey the same equation made linear, with the same matrix I - diag(d_0) (A + E
/// dp/dzeta), and cells of their own; that by alpha has the slope of every cell's coefficients as its source.
class FractionalRecursion {
public:
    FractionalRecursion(const FractionalPnlss& structure, const FractionalGrid&, bool linearFree, bool alphaFree);

    /// A, B, C, D where free, then what is free of E and F (row by row, as of Recursion), then alpha where free.
    Eigen::Index parameters() const { return linear_.parameters() + (alphaFree_ ? 1 : 0); }
    Eigen::VectorXd valuesOf(const FractionalPnlss&) const;
    void setValues(FractionalPnlss&, const Eigen::VectorXd&) const;

    struct Trajectory {
        Eigen::MatrixXd states, derivatives;  ///< zeta and v, n x (N substeps)
        Eigen::MatrixXd output;               ///< y, N x p, at samples
    };

    /// @param input  (N substeps) x m, on the fine grid; from rest
    /// @return false where the states leave `bound`, or a step has no solution
    bool run(const FractionalPnlss&, const Eigen::MatrixXd& input, double bound, Trajectory&) const;

    /// The exact Jacobian along a run, at samples, block by block in ascending time; as Recursion::Consumer without
    /// initial states.
    void differentiate(const FractionalPnlss&, const Eigen::MatrixXd& input, const Trajectory&,
                       const Recursion::Consumer&) const;

private:
    FractionalGrid grid_;
    Eigen::Index n_, m_, p_;
    Eigen::Array<bool, Eigen::Dynamic, 1> fractional_;
    bool alphaFree_;
    Recursion linear_;  // parameters that are no order
    MonomialProducts monomials_;
};

}  // namespace excursion
