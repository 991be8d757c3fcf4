// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/ExponentialStep.h"

#include <array>
#include <span>
#include <vector>

namespace excursion {

/// The split equations of ExponentialStep, where the laws' part is a parabola through its latest three values
/// (exponential Adams-Bashforth method of third order; Cox & Matthews 2002, section 2):
///     N(t_n + s h) = N_n + s D + s (s + 1)/2 D2,   D = N_n - N_(n-1),  D2 = N_n - 2 N_(n-1) + N_(n-2),   0 <= s <= 1.
/// The laws are asked once a step instead of four times: for real time, where the rate is high already. Where they are
/// too fast for that, what the parabola misses at the step's end is found there and counted in, as the cubic through
/// all four (a predictor and corrector of fourth order, Adams-Moulton): that is stable for steps four times as long,
/// and asks twice.
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
    /// @returns dv/dt at the step's end under the input there, m/s^2
    double step(std::span<const double> u);

    const Eigen::VectorXd& state();                                 ///< (i, x, v, memories)
    double current() const { return motion_.current(); }            ///< A
    double displacement() const { return motion_.displacement(); }  ///< m
    double velocity() const { return motion_.velocity(); }          ///< m/s

private:
    ExponentialStep motion_;
    const bool corrected_;
    TiledProduct carry_;    ///< of from_ to run_
    TiledProduct correct_;  ///< of what the parabola misses of the rates, likewise
    /// states that move coil and cone, u, the parabola of the rates, states that follow
    std::vector<double> from_;
    std::vector<double> run_;  ///< at the end: moving, (A_i z, A_v z), following
    Eigen::VectorXd state_;
    std::array<Eigen::VectorXd, 3> past_;  ///< N now, one and two steps ago
    Eigen::VectorXd missed_;
};

}  // namespace excursion
