// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Numerics/SearchSummary.h"
#include "Engine/Polynomial/Pnlss/PnlssFit.h"

#include <complex>
#include <functional>
#include <vector>

namespace excursion {

/// The least squares of a parallel Hammerstein model whose branches are too long for normal equations, by conjugate
/// gradients (CGLS; Bjoerck 1996, 7.4): each product with the regressors, or with their transpose, is a few DFTs of a
/// record. Unknowns: the offset, then the K taps of each branch.
class LongHammerstein {
public:
    /// @param T  polynomials P = [u, u^2 .. u^N] T of the input that the branches filter, N x N
    LongHammerstein(const std::vector<InputOutputRecord>&, const Eigen::MatrixXd& T, Eigen::Index taps);

    /// What is told every few iterations; false ends the search.
    using Judge = std::function<bool(const Eigen::VectorXd& unknowns, int iterations)>;

    /// How it ended; costs are the sum below.
    struct Solution : SearchSummary {
        Eigen::VectorXd unknowns;
    };

    /// Lowers |y - A x|^2 + r samples |x without offset|^2 from x = 0. Ends also where its gradient has fallen to 1e-10
    /// of what it was.
    Solution solve(double regularization, int iterations, int every, const Judge&) const;

private:
    struct Stretch {
        std::size_t length;                                          ///< of the DFT
        std::vector<std::vector<std::complex<double>>> polynomials;  ///< spectrum of each P_n
        Eigen::VectorXd output;
        Eigen::Index skip;
    };

    /// A x, 0 where nothing is judged
    Eigen::VectorXd forward(const Stretch&, const Eigen::VectorXd& unknowns) const;
    void addBackward(const Stretch&, const Eigen::VectorXd& rest, Eigen::VectorXd& sum) const;  ///< A^T r

    std::vector<Stretch> stretches_;
    Eigen::Index branches_, taps_;
    double samples_ = 0.0;
};

}  // namespace excursion
