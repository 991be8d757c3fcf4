// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/Frf.h"
#include "Engine/Linear/FrequencyData.h"
#include "Engine/Linear/StateSpace.h"

namespace excursion {

/// What frequency responses are computed at: lambda = z - 1 in discrete time, lambda = j w in continuous time, so that
///     G = C (lambda I - L)^-1 B + D,  L = A - I or A.
/// z - 1 = 2j sin(w/2) exp(j w/2), w = 2 pi f / fs, loses no digits at frequencies far below the sample rate, where z
/// itself would.
/// @param alpha  of systems of fractional order in continuous time: lambda = (j w)^alpha
std::complex<double> evaluationPoint(double frequency, double sampleRate, double alpha = 1.0);
Eigen::VectorXcd evaluationPoints(const std::vector<double>& frequency, double sampleRate, double alpha = 1.0);

/// (lambda I - L)^-1 for many lambda, by one complex Schur form L = U T U^H and a triangular solve a point.
class Resolvent {
public:
    explicit Resolvent(const StateSpace&);

    /// C (lambda I - L)^-1, p x n.
    Eigen::MatrixXcd left(std::complex<double> lambda) const;

    /// C (lambda I - L)^-1 B + D, p x m.
    Eigen::MatrixXcd response(std::complex<double> lambda) const;

private:
    Eigen::MatrixXcd T_, U_, CU_, UB_, D_;
    Eigen::MatrixXcd solveLeft(std::complex<double> lambda) const;  // C U (lambda I - T)^-1
};

/// The frequency response at frequencies in Hz, one p x m matrix each. Throws Error (usage) when the model is not
/// valid.
std::vector<Eigen::MatrixXcd> respond(const StateSpace&, const std::vector<double>& frequency);

/// The response of one input and output, as an Frf without variances.
Frf frfOf(const StateSpace&, const std::vector<double>& frequency, Eigen::Index output = 0, Eigen::Index input = 0);

/// The model's own response where its poles show: `lines` frequencies, evenly on a logarithmic scale, from a tenth of
/// the slowest pole to ten times the fastest or to half the sample rate.
/// @param alpha  of a model in lambda = s^alpha
FrequencyData sampled(const StateSpace&, int lines = 1000, double alpha = 1.0);

/// 20 log10(|model - measured| / |measured|), rms over the lines of the Frf [B 4.26].
double relativeErrorDb(const Frf& measured, const Frf& model);

}  // namespace excursion
