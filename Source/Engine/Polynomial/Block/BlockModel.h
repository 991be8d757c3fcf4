// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/Pnlss/Pnlss.h"

#include <string>
#include <string_view>
#include <vector>

namespace excursion {

/// Where a static polynomial stands beside the linear dynamics G.
enum class BlockBranch {
    hammerstein,  ///< before it: G[P(u)]
    wiener,       ///< behind it: P(G[u])
    feedback      ///< between two of it: G[P(G[u])], what a loop around G adds to first order
};

std::string_view name(BlockBranch);  ///< "hammerstein", "wiener", "feedback"
std::vector<BlockBranch> blockBranches();

/// The generic block model of [B 4.1.1, figure 4.2], of one input and one output, in discrete time:
///     w = G[u],   y = y0 + w + P_W(w) + G[P_H(u) + P_F(w)],   P(v) = c_2 v^2 + c_3 v^3 + ..
/// with the same linear G in all branches. The gain c of the linear branch there is 1 here: it is the same model with
/// G, c_k other by powers of c. No branch closes a loop, so the model is stable where G is. It is a PNLSS model with
/// two copies of G's states.
struct BlockModel {
    StateSpace linear;  ///< G, one input, one output
    /// c_2, c_3, .. of P_H (input unit^(1-k)), P_W, P_F; empty: there is no such branch
    Eigen::VectorXd hammerstein, wiener, feedback;
    double offset = 0.0;  ///< y0

    const Eigen::VectorXd& of(BlockBranch) const;
    Eigen::VectorXd& of(BlockBranch);

    /// The coefficients of G's transfer function, 2 n + 1, those of the polynomials, and the offset.
    Eigen::Index parameters() const;

    /// @param reason  where not null: one sentence that says what is wrong
    bool isValid(std::string* reason = nullptr) const;
};

/// What each branch adds to the output, from rest.
struct BlockOutputs {
    Eigen::VectorXd linear;                         ///< w
    Eigen::VectorXd hammerstein, wiener, feedback;  ///< zero where there is no such branch

    const Eigen::VectorXd& of(BlockBranch) const;
};

/// Throws Error (usage) for a model or an input, N x 1, that does not fit.
BlockOutputs branchOutputs(const BlockModel&, const Eigen::MatrixXd& input);

/// The output, N x 1: the offset and the sum of the branches.
Eigen::MatrixXd simulate(const BlockModel&, const Eigen::MatrixXd& input);

/// The same model as PNLSS: states x of w, then those of the other copy of G, from rest at 0.
Pnlss pnlssOf(const BlockModel&);

/// The loop that the feedback branch stands for, closed: a PNLSS model with one copy of G's states,
///     x(t+1) = A x + B v,  w = C x + D u,  y = y0 + w + D (v - u) + P_W(w),  v = u + P_H(u) + P_F(w)
/// It differs from the block model by what goes through two polynomials, one after the other. Its linear part is G's,
/// but of large signals such a loop can run away. With half the states it is a start for fitPnlss() that holds the
/// nonlinearity already.
Pnlss closedLoop(const BlockModel&);

/// c_2 v^2 + c_3 v^3 + .. of each element, and its derivative.
Eigen::ArrayXd polynomial(const Eigen::VectorXd& coefficients, const Eigen::ArrayXd& v);
Eigen::ArrayXd polynomialSlope(const Eigen::VectorXd& coefficients, const Eigen::ArrayXd& v);

}  // namespace excursion
