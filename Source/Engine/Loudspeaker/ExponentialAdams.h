// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/ExponentialStep.h"

#include <array>
#include <span>
#include <vector>

namespace excursion {

/// The split equations of ExponentialStep, with the laws' part as a parabola through its latest three values
/// (exponential Adams-Bashforth method of third order; Cox & Matthews 2002, section 2):
///     N(t_n + s h) = N_n + s D + s (s + 1)/2 D2,   D = N_n - N_(n-1),  D2 = N_n - 2 N_(n-1) + N_(n-2),   0 <= s <= 1.
/// The laws are evaluated once per step instead of four times. This suits real time, where the rate is already high. If
/// the laws are too fast for that, the error of the parabola at the step's end is evaluated and corrected, as the cubic
/// through all four values (a fourth-order predictor-corrector, Adams-Moulton). That is stable for steps four times as
/// long, and takes two evaluations.
///
/// Thread: after construction nothing allocates, locks or throws.
class ExponentialAdams {
public:
    /// @param h  step, s; the laws' fastest eigenvalue (ExponentialStep::fastestLaw) times h must stay below `stable`,
    /// or `stableCorrected`
    ExponentialAdams(const Model&, double h, bool corrected);

    /// the methods' own limits on the real axis are 6/11 and 1.92
    static constexpr double stable = 0.4, stableCorrected = 1.5;

    static constexpr int inputs = 4;  ///< coefficients of an input polynomial

    int order() const { return motion_.order(); }

    /// Starts from rest.
    void reset();

    /// Advances by h.
    /// @param u  as in ExponentialStep::step, at most `inputs`
    /// @returns dv/dt at the step's end with the input there, m/s^2
    double step(std::span<const double> u);

    /// The memory of an effect that is slow (Effect::slow), to be set at rest; empty if the model has no such effect.
    std::span<double> slow(const Effect&);

    const Eigen::VectorXd& state();                                 ///< (i, x, v, memories)
    double current() const { return motion_.current(); }            ///< A
    double displacement() const { return motion_.displacement(); }  ///< m
    double velocity() const { return motion_.velocity(); }          ///< m/s

private:
    ExponentialStep motion_;
    const bool corrected_;
    TiledProduct carry_;    ///< of from_ to run_
    TiledProduct correct_;  ///< of the parabola's error of the rates, likewise
    /// states that drive coil and cone, u, the parabola of the rates, states that follow
    std::vector<double> from_;
    std::vector<double> run_;  ///< at the end: moving, (A_i z, A_v z), following
    Eigen::VectorXd state_;
    std::array<Eigen::VectorXd, 3> past_;  ///< N now, one and two steps ago
    Eigen::VectorXd missed_;
};

}  // namespace excursion
