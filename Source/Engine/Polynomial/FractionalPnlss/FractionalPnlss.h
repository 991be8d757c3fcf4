// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Fractional/FractionalIntegrator.h"
#include "Engine/Fractional/FractionalStateSpace.h"
#include "Engine/Numerics/DiffusiveLadder.h"
#include "Engine/Polynomial/Pnlss/Pnlss.h"

namespace excursion {

/// A polynomial state-space model of fractional order [B 7.1, 7.2], in continuous time:
///     D^a_i zeta_i = (A zeta + B u + E p(zeta, u))_i,   y = C zeta + D u + F p(zeta, u)
/// where some states have the order a_i = alpha, 0 < alpha < 1, and the others 1. So the same model carries a
/// loudspeaker's semi-inductance and its nonlinearities: D x = v, D v = .., D^alpha i = .. .
struct FractionalPnlss {
    double alpha = 0.5;
    Eigen::Array<bool, Eigen::Dynamic, 1> fractional;  ///< n: the states of order alpha
    Pnlss form;                                        ///< as of continuous time: sample rate 0; A in 1/s^a_i

    double order(Eigen::Index state) const { return fractional[state] ? alpha : 1.0; }

    /// @param reason  where not null: one sentence that says what is wrong
    bool isValid(std::string* reason = nullptr) const;
};

/// The model with monomials at coefficients of zero; in a form of continuous time every state is of order alpha, or of
/// order 1, as `fractional` says. As withTerms() of Pnlss.
FractionalPnlss withTerms(const StateSpace& form, double alpha, const Eigen::Array<bool, Eigen::Dynamic, 1>& fractional,
                          int degree, TermMask = TermMask::full, bool offset = false);

/// The same of a commensurate model: all states are of order alpha.
FractionalPnlss withTerms(const FractionalStateSpace&, int degree, TermMask = TermMask::full, bool offset = false);

/// The frequency response of the linear part, C (diag((j w)^a_i) - A)^-1 B + D, at frequencies in Hz; one p x m matrix
/// each.
std::vector<Eigen::MatrixXcd> respondLinear(const FractionalPnlss&, const std::vector<double>& frequency);

/// How time is cut: `substeps` steps a sample, and the ladder of the fractional states.
struct FractionalGrid {
    double sampleRate = 0.0;  ///< Hz, of inputs and outputs
    int substeps = 1;
    DiffusiveLadderOptions band;

    double step() const { return 1.0 / (sampleRate * substeps); }
};

/// The integrator of every state on a grid.
std::vector<FractionalIntegrator> integratorsOf(const Eigen::Array<bool, Eigen::Dynamic, 1>& fractional, double alpha,
                                                const FractionalGrid&);

/// The coarsest grid on which the discretized linear part is stable where the model is meant to be, and follows the
/// exact response to within the tolerance: the relative rms error over the frequencies. At most 16 substeps; what they
/// can't reach is taken as it is.
/// @param frequency  Hz, where the input has power @param seconds  length of the records: the ladder remembers as long
FractionalGrid gridFor(const FractionalPnlss&, double sampleRate, const std::vector<double>& frequency, double seconds,
                       double tolerance = 1e-4);

/// 20 log10 of that error on a given grid, and whether the discretized linear part is stable there.
struct GridError {
    double errorDb = 0.0;
    bool stable = false;
};
GridError errorOf(const FractionalPnlss&, const FractionalGrid&, const std::vector<double>& frequency);

/// The linear part on the grid as an ordinary model of discrete time at sampleRate * substeps: the ladder's cells and
/// the last values of every derivative are its states.
StateSpace expandedLinear(const FractionalPnlss&, const FractionalGrid&);

/// Whether that is stable. Cells slower than the record stand at 1 up to rounding, and are not held against it.
bool isStable(const FractionalPnlss&, const FractionalGrid&);

}  // namespace excursion
