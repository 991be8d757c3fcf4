// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/Volterra/Volterra.h"

#include <string>
#include <vector>

namespace excursion {

/// A Volterra series of one input and one output to order 3 with finite memory [B 3.2], in discrete time:
///     y(t) = h0 + sum_i h1(i) u(t-i) + sum_ij h2(i,j) u(t-i) u(t-j) + sum_ijk h3(i,j,k) u(t-i) u(t-j) u(t-k)
/// with symmetric kernels. It has no feedback, so it is stable whatever its coefficients.
struct VolterraSeries {
    double sampleRate = 0.0;             ///< Hz
    double offset = 0.0;                 ///< h0
    Eigen::VectorXd first;               ///< h1, output unit / input unit
    Eigen::MatrixXd second;              ///< h2, square; may be empty
    std::vector<Eigen::MatrixXd> third;  ///< h3: as many matrices as one has rows and columns; may be empty

    /// Those that are not alike by symmetry: 1 + T1 + T2 (T2 + 1) / 2 + T3 (T3 + 1) (T3 + 2) / 6.
    Eigen::Index parameters() const;

    /// @param reason  where not null: one sentence that says what is wrong
    bool isValid(std::string* reason = nullptr) const;
};

/// The output, N x 1, for an input of N samples, N x 1, from rest, in O(N (T1 + T2^2 + T3^3)). Throws Error (usage) for
/// what does not fit.
Eigen::MatrixXd simulate(const VolterraSeries&, const Eigen::MatrixXd& input);

/// The kernels of a PNLSS model of one input and one output, cut off after T1, T2 and T3 samples; 0 leaves the second
/// or the third out.
/// Throws Error (usage) for models with several inputs or outputs, T1 below 1, or memories above 65536, 2048 and 128
/// samples; and as Volterra does.
VolterraSeries volterraSeries(const Pnlss&, Eigen::Index memory1, Eigen::Index memory2, Eigen::Index memory3 = 0);

}  // namespace excursion
