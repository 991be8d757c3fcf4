// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/Pnlss.h"
#include "Engine/Polynomial/PnlssRecord.h"
#include "Engine/Progress.h"

#include <string>
#include <vector>

namespace excursion {

struct PnlssFitOptions {
    int maximumIterations = 100;
    double costTolerance = 1e-8;        ///< stop when three accepted steps in a row lower the cost by less than this fraction
    double rankTolerance = 1e-13;       ///< singular values of the scaled Jacobian below this, relative to the largest, are cut off
    bool linearFree = true;             ///< A, B, C, D move too
    bool estimateInitialStates = false; ///< each record's first state is a parameter; else it is zero, and `skip` has to do
    std::vector<double> guideGains;     ///< see fitPnlss; empty: a pure simulation from the start

    /// Weights of the error's spectrum, one a line 0 .. N/2 of the judged samples of each record (all equally long, periodic); empty: all equal.
    Eigen::VectorXd lineWeights;

    bool isValid(std::string* reason = nullptr) const;
};

/// What became of a fit; the default is failure.
struct PnlssFit {
    Pnlss model;
    std::vector<Eigen::VectorXd> initialStates;   ///< one a record, where they were estimated
    double estimationDb = 0.0, validationDb = 0.0;   ///< relative rms error (seed 4.26), of the model that is returned; validation NaN without records
    int iterations = 0;
    bool converged = false;
    bool stable = false;             ///< its linear part is stable and no record made it run away
    std::string reason = "the fit was not run";
    std::vector<double> history;     ///< relative rms error in dB on the estimation records after each accepted step
};

/// 20 log10(|model - measured| / |measured|) over all records and outputs, samples after `skip`; +infinity when the model runs away.
double relativeErrorDb(const Pnlss&, const std::vector<PnlssRecord>&, const std::vector<Eigen::VectorXd>& initialStates = {});

/// Levenberg-Marquardt on the simulation error (seed 4.3.1 and appendix C), columns scaled to unit length, singular values truncated.
///
/// Only the triangular factor of [J, r] is kept, gathered block by block by orthogonal transformations, so memory stays bounded and no condition
/// number is squared: what the seed loses to its normal equations. The damping falls a hundredfold with every step that is taken, so that weak directions
/// move early; with a slow fall the search would creep along curved valleys.
/// A step that lets a simulation run away is refused. Where there are validation records the model with the least error on them is returned.
///
/// Guided start: with gains g_1 > g_2 > .. the model is first fitted while it follows the measured output, x(t+1) = f(x, u) + g L (y - yhat), L the gain
/// of a Kalman filter on the linear part. A guided model cannot drift away from the data, so its error is far smoother in the parameters than that of
/// a simulation over thousands of samples; as g falls to 0 it becomes the simulation. Such a start also copes with a linear part that is not stable.
PnlssFit fitPnlss(const Pnlss& start, const std::vector<PnlssRecord>& estimation, const std::vector<PnlssRecord>& validation,
                  const PnlssFitOptions& = {}, const Progress& = {});

} // namespace excursion
