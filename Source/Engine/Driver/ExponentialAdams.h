// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Driver/ExponentialStep.h"

#include <array>
#include <span>

namespace excursion {

/// The split equations of ExponentialStep, where the laws' part is a parabola through its latest three values (exponential Adams-Bashforth
/// method of third order; Cox & Matthews 2002, section 2):
///     N(t_n + s h) = N_n + s D + s (s + 1)/2 D2,   D = N_n - N_(n-1),  D2 = N_n - 2 N_(n-1) + N_(n-2),   0 <= s <= 1.
/// The laws are asked once a step instead of four times: for real time, where the rate is high already.
///
/// Thread: after construction nothing allocates, locks or throws.
class ExponentialAdams {
public:
    /// @param h  step, s; the laws' fastest eigenvalue (ExponentialStep::fastestLaw) times h must stay below `stable`
    ExponentialAdams(const Model&, double h);

    static constexpr double stable = 0.4;   ///< the method's own limit on the real axis is 6/11

    int order() const { return motion_.order(); }

    /// Starts from rest.
    void reset();

    /// Advances by h.
    /// @param u  as in ExponentialStep::step
    /// @returns dv/dt at the step's end under the input there, m/s^2
    double step(std::span<const double> u);

    const double* state() const { return z_.data(); }   ///< (i, x, v, memories)

private:
    ExponentialStep motion_;
    Eigen::MatrixXd linear_;    ///< (z, u) -> (z, y) at the end without the laws; rows padded
    Eigen::MatrixXd ahead_;     ///< the parabola's coefficients -> what it adds to (z, y); rows padded
    Eigen::VectorXd z_, from_, run_, parabola_;
    std::array<Eigen::VectorXd, 3> past_;   ///< N now, one and two steps ago
};

} // namespace excursion
