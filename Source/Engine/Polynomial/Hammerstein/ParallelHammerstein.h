// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include <string>
#include <vector>

namespace excursion {

/// A parallel Hammerstein model of one input and one output ([B 3.3]; Novak, Lotton & Simon 2015), in discrete time:
///     y(t) = y0 + sum_{n=1..N} sum_{k=0..K-1} g_n(k) u(t - k)^n
/// Branch n filters the n-th power of the input by a finite impulse response, so the model is stable whatever its
/// coefficients. It is the Volterra series whose kernels are zero off their diagonals, and knows no feedback: of a
/// loudspeaker it is an approximation. The powers are taken of the samples: of inputs that reach above fs / (N + 1) the
/// highest of them fold back, as they do not in an analog system.
struct ParallelHammerstein {
    double sampleRate = 0.0;  ///< Hz
    Eigen::MatrixXd filters;  ///< K x N, column n-1: g_n, output unit / input unit^n
    double offset = 0.0;      ///< y0, output unit

    Eigen::Index degree() const { return filters.cols(); }
    Eigen::Index length() const { return filters.rows(); }
    Eigen::Index parameters() const { return filters.size() + 1; }

    /// @param reason  where not null: one sentence that says what is wrong
    bool isValid(std::string* reason = nullptr) const;
};

/// The output, N x 1, for an input of N samples, N x 1, from rest. Throws Error (usage) for a model or an input that
/// does not fit.
Eigen::MatrixXd simulate(const ParallelHammerstein&, const Eigen::MatrixXd& input);

/// The frequency responses G_n(f) = sum_k g_n(k) exp(-2 pi j f k / fs) of all branches: frequencies x N.
Eigen::MatrixXcd responses(const ParallelHammerstein&, const std::vector<double>& frequency);

}  // namespace excursion
