// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/MonomialProducts.h"
#include "Engine/Polynomial/Pnlss/Pnlss.h"

#include <Eigen/Core>

#include <functional>
#include <vector>

namespace excursion {

/// The recursion of a PNLSS model and of its derivatives, compiled once for a structure and run often: by every step of
/// a fit.
///
/// The sensitivities X = dx/dtheta obey a linear recursion that varies in time [B 4.22]:
///     X(t+1) = M(t) X(t) + e_i r_j(t),  dy/dtheta = G(t) X(t) [+ e_o r_j(t)],   M = A + E dp/dx,  G = C + F dp/dx
/// where a parameter is the coefficient of regressor r_j, r = (x, u, p), in row i of the state or row o of the output
/// equation. M and G are computed for a block of time steps at once, vectorized along time, from products that
/// monomials share. Then a few parameters at a time, side by side, run through the block with X in registers.
class Recursion {
public:
    /// @param linearFree  A, B, C, D are parameters too, not E and F alone
    Recursion(const Pnlss& structure, bool linearFree);

    /// What a parameter is: the coefficient of a regressor in a row.
    struct Column {
        Eigen::Index row;        ///< states first, then outputs
        Eigen::Index regressor;  ///< x, u, monomials
    };
    const std::vector<Column>& columns() const { return columns_; }
    Eigen::Index parameters() const { return static_cast<Eigen::Index>(columns_.size()); }
    Eigen::VectorXd valuesOf(const Pnlss&) const;
    void setValues(Pnlss&, const Eigen::VectorXd&) const;

    /// Follows a measured output while it runs: x(t+1) gets L (y(t) - yhat(t)) added, as an observer does. Without: a
    /// pure simulation.
    struct Guide {
        Eigen::MatrixXd gain;           ///< L, n x p
        const Eigen::MatrixXd* output;  ///< measured, N x p
    };

    /// @param states   becomes n x (N + 1), @param outputs N x p
    /// @return false where the states leave `bound` (in the units of the states), or are not finite
    bool run(const Pnlss&, const Eigen::MatrixXd& input, const Eigen::VectorXd& initial, double bound,
             Eigen::MatrixXd& states, Eigen::MatrixXd& outputs, const Guide* guide = nullptr) const;

    /// Takes the derivatives of a stretch of T outputs: one matrix an output, T x (parameters + n), the last n columns
    /// those by the initial state.
    using Consumer = std::function<void(Eigen::Index first, std::vector<Eigen::MatrixXd>& derivatives)>;

    /// The exact Jacobian along a run, block by block in ascending time; memory does not grow with the record.
    void differentiate(const Pnlss&, const Eigen::MatrixXd& input, const Eigen::MatrixXd& states, const Consumer&,
                       const Guide* guide = nullptr) const;

    /// J^T w along a run, one number a parameter and then one a state of the beginning, by the adjoint recursion
    /// backwards in time:
    ///     lambda(t) = M(t)^T lambda(t+1) + G(t)^T w(t),  by the coefficient of r_j in state row i: sum_t lambda_i(t+1)
    ///         r_j(t), in output row o: sum_t w_o(t) r_j(t)
    /// at the cost of a few simulations, whatever the number of parameters.
    /// @param weights  w, N x p
    Eigen::VectorXd pullBack(const Pnlss&, const Eigen::MatrixXd& input, const Eigen::MatrixXd& states,
                             const Eigen::MatrixXd& weights, const Guide* guide = nullptr) const;

private:
    /// What the model is along a stretch of time.
    struct Stretch {
        Eigen::MatrixXd values;  ///< of the regressors' nodes: [node][time], `pitch` apart
        Eigen::MatrixXd MG;      ///< entries of M, then of G, row by row: [entry][time]
    };
    Stretch room() const;
    void follow(const Pnlss&, const Eigen::MatrixXd& input, const Eigen::MatrixXd& states, const Guide*,
                Eigen::Index first, Eigen::Index T, Stretch&) const;
    Eigen::Index nodeOf(Eigen::Index regressor) const;

    struct Group {  // columns of one row, side by side
        Eigen::Index row, first, count;
    };

    std::vector<Eigen::Index> regressorLanes(const std::vector<Group>&, const std::vector<Eigen::Index>& place) const;

    Eigen::Index n_, m_, p_;
    std::vector<Column> columns_;
    std::vector<Group> groups_;
    MonomialProducts monomials_;
};

}  // namespace excursion
