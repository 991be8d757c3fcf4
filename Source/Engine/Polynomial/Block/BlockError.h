// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Numerics/Search.h"
#include "Engine/Polynomial/Block/BlockModel.h"
#include "Engine/Polynomial/Pnlss/PnlssFit.h"
#include "Engine/Polynomial/Pnlss/Recursion.h"

#include <vector>

namespace excursion {

/// The simulation error of a block model, to be lowered in all its coefficients: A, B, C, D of G, then those of the
/// polynomials, then the offset. With v = P_H(u) + P_F(w), dw = (dG)[u] the derivatives by those of G are
///     dy = (1 + P_W'(w)) dw + G[P_F'(w) dw] + (dG)[v]
/// A model whose G is not stable counts as one that runs away.
class BlockError final : public SearchProblem {
public:
    /// @param structure  which branches there are, and their degrees
    BlockError(const BlockModel& structure, const std::vector<InputOutputRecord>&);

    Eigen::VectorXd valuesOf(const BlockModel&) const;
    BlockModel modelAt(const Eigen::VectorXd& values) const;

    double cost(const Eigen::VectorXd& values) override;
    Eigen::MatrixXd factor(const Eigen::VectorXd& values) override;

private:
    Eigen::MatrixXd derivatives(const BlockModel&, const Eigen::VectorXd& v) const;  // of G[v] by A, B, C, D

    BlockModel structure_;
    Recursion recursion_;
    const std::vector<InputOutputRecord>& records_;
    double power_;
};

/// Each column through G, from rest.
Eigen::MatrixXd filtered(const StateSpace& G, const Eigen::MatrixXd& columns);

}  // namespace excursion
