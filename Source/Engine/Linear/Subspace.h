// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/FrequencyData.h"
#include "Engine/Linear/StateSpace.h"

#include <Eigen/Core>

namespace excursion {

/// Frequency-domain subspace identification ([B 4.2.3 and appendix B]; McKelvey, Akcay & Ljung 1996). From
///     p_i(z_k) G_k = C p_i(A) (z_k I - A)^-1 B + (a polynomial of degree i - 1 in z_k)
/// for i = 0 .. q-1, the second term is projected out; what is left has the range of the extended observability matrix
/// [C p_0(A); ..; C p_{q-1}(A)], whose shift property is the recurrence of the p_i and yields A.

/// The range of the observability matrix, from which a model of any order below its rows is taken.
struct ObservabilityRange {
    Eigen::MatrixXd U;               ///< q p x q p, orthonormal columns by descending singular value
    Eigen::VectorXd singularValues;  ///< relative to the first
    Eigen::MatrixXd H;               ///< recurrence of the polynomials, (q+1) x q
    double constant = 1.0;           ///< p_0
    Eigen::VectorXd outputScale;     ///< U is of outputs times this
    double sampleRate = 0.0;         ///< Hz
};

/// Algorithm 2: any grid, weighted by the variance. The lines are divided by their deviation and the p_i made
/// orthonormal under those weights, so the projected noise is white by construction and needs no further weighting
/// ([B 4.2.3] takes the square root of a covariance matrix there).
/// @param data  frequencies up to sampleRate / 2
/// @param q     block rows, above order; fewer come out where the lines do not carry so many. Far more than the order
/// cost little and
///              buy digits: exact data of order 3 is met at -240 dB with 8, at -275 dB with 60 of them
ObservabilityRange observabilityRange(const FrequencyData&, double sampleRate, Eigen::Index q);

/// The same for lines at any points z_k of the complex plane, closed under conjugation with their conjugates;
/// sampleRate is left at 0.
ObservabilityRange observabilityRange(const FrequencyData&, const Eigen::VectorXcd& points, Eigen::Index q);

/// Algorithm 1: a uniform grid k fs/N, k = 0 or 1 .. N/2, without weights. The inverse DFT of the response, a Hankel
/// matrix of it and its SVD. A missing line at 0 or fs/2 is filled by cubic extrapolation of the real part. Throws
/// Error (data) when the grid is not of that kind.
ObservabilityRange observabilityRangeUniform(const FrequencyData&, double sampleRate, Eigen::Index q);

/// A and C of the wanted order. @param order  below U.rows() / p
/// @param stable  poles outside of the unit circle are mirrored into it
StateSpace dynamicsOf(const ObservabilityRange&, Eigen::Index order, Eigen::Index inputs, bool stable);

/// B and D by weighted linear least squares, A and C given; also for continuous time. Directions of the basis that are
/// no more than rounding are left out. @param alpha  of a model in s^alpha
void fitInputs(StateSpace&, const FrequencyData&, double alpha = 1.0);

/// The model with every pole outside of the stable region mirrored into it: 1/conj(z), or -conj(s); response magnitudes
/// do not stay.
StateSpace mirrored(const StateSpace&);

/// The block rows that identifySubspace takes: 2 order + 2, and at least 60 where there are lines enough.
Eigen::Index blockRowsFor(Eigen::Index order, Eigen::Index lines);

/// All of it, discrete time. Throws Error (usage) for a bad order, (data) for too few lines or lines beyond sampleRate
/// / 2.
StateSpace identifySubspace(const FrequencyData&, double sampleRate, Eigen::Index order, bool stable = true);

}  // namespace excursion
