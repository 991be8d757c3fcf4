// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include <complex>
#include <string>
#include <vector>

namespace excursion {

/// A linear state-space model [B 4.2.1] with n states, m inputs and p outputs.
///     discrete time    x(t+1) = A x(t) + B u(t),  y(t) = C x(t) + D u(t),  t counts samples
///     continuous time  dx/dt  = A x + B u,        y = C x + D u,           time in seconds
/// A is n x n, B n x m, C p x n, D p x m; n may be 0. Inputs and outputs are in SI units, states in whatever basis.
struct StateSpace {
    Eigen::MatrixXd A, B, C, D;
    double sampleRate = 0.0;  ///< Hz; 0: continuous time

    Eigen::Index order() const { return A.rows(); }
    Eigen::Index inputs() const { return D.cols(); }
    Eigen::Index outputs() const { return D.rows(); }
    bool continuous() const { return sampleRate == 0.0; }

    /// Shapes fit and all is finite. @param reason  where not null: one sentence that says what is wrong
    bool isValid(std::string* reason = nullptr) const;
};

/// The eigenvalues of A, by ascending size of the imaginary part, then of the real part: rad/s in continuous time, else
/// in z.
std::vector<std::complex<double>> poles(const StateSpace&);

/// The finite transmission zeros of a square model (inputs = outputs): where [A - s I, B; C, D] loses rank. Same order
/// as poles(). Zeros whose size is beyond 1e8 times the largest pole count as infinite. Throws Error (usage) when the
/// model is not square.
std::vector<std::complex<double>> zeros(const StateSpace&);

/// How far the model is from not being stable: in discrete time 1 - max |pole|, in continuous time -max Re(pole) in
/// 1/s. Above 0 exactly when it is stable; infinite without states.
double stabilityMargin(const StateSpace&);
bool isStable(const StateSpace&);

/// The model in another basis, x = T z: (T^-1 A T, T^-1 B, C T, D).
StateSpace transformed(const StateSpace&, const Eigen::MatrixXd& T);

}  // namespace excursion
