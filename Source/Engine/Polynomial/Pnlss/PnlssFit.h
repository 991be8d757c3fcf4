// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Numerics/SearchSummary.h"
#include "Engine/Polynomial/Pnlss/Pnlss.h"
#include "Engine/Polynomial/Pnlss/PnlssFitOptions.h"
#include "Engine/Polynomial/Pnlss/ResidualTest.h"
#include "Engine/Polynomial/InputOutputRecord.h"
#include "Engine/Progress.h"

#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// Where a search sets out.
struct PnlssStart {
    Pnlss model;
    std::vector<Eigen::VectorXd> initialStates;  ///< one a record, where they are estimated; empty: zero
};

/// What became of a fit: iterations are those of all ways, the rest of the summary is that of the way that was kept.
/// Costs are relative squared errors, weighted where lines are.
struct PnlssFit : SearchSummary {
    Pnlss model;
    std::vector<Eigen::VectorXd> initialStates;  ///< one a record, where they were estimated
    /// relative rms error [B 4.26], of the model that is returned; validation NaN without records
    double estimationDb = 0.0, validationDb = 0.0;
    std::optional<UntoldNoise> untold;  ///< what is left that the input does not tell, where the residual was judged
    bool stable = false;                ///< its linear part is stable and no record made it run away
    /// relative rms error in dB, mean and all, on the estimation records after each accepted step of the way that was
    /// kept
    std::vector<double> history;
};

/// 20 log10(|model - measured| / |measured|) over all records and outputs, samples after `skip`; +infinity when the
/// model runs away.
double relativeErrorDb(const Pnlss&, const std::vector<InputOutputRecord>&,
                       const std::vector<Eigen::VectorXd>& initialStates = {});

/// Levenberg-Marquardt on the simulation error [B 4.3.1, appendix C], columns scaled to unit length, singular
/// values truncated, steps bent along the error's valleys (see Engine/Numerics/Search.h).
///
/// Only the triangular factor of [J, r] is kept, gathered block by block by orthogonal transformations, so memory stays
/// bounded and no condition number is squared: what [B] loses to its normal equations. A step that lets a
/// simulation run away is refused. Where there are validation records the model with the least error on them is
/// returned.
///
/// A plain search may end in a valley that leads nowhere; which one depends on where it sets out. Three ways fail in
/// different cases, so each is gone for half of the iterations, and the best one on to their end.
///
/// Guided: with gains g_1 > g_2 > .. the model is first fitted while it follows the measured output, x(t+1) = f(x, u) +
/// g L (y - yhat), L the gain of a Kalman filter on the linear part. A guided model cannot drift away from the data, so
/// its error is far smoother in the parameters than that of a simulation over thousands of samples; as g falls to 0 it
/// becomes the simulation. Such a search also copes with a linear part that is not stable.
///
/// Grown: a quarter of a record lets errors of the model add up for a shorter time, and its error has fewer valleys.
/// Weights of the spectrum come later.
PnlssFit fitPnlss(const Pnlss& start, const std::vector<InputOutputRecord>& estimation,
                  const std::vector<InputOutputRecord>& validation, const PnlssFitOptions& = {}, const Progress& = {});

/// From several starts of one structure, such as linear models that were found in different ways (see LinearStarts.h):
/// where one leads into a valley, another need not. Each is gone in the ways that the options name until one is good
/// enough; then the best one goes on. Throws Error (usage) without a start, or where structures differ.
PnlssFit fitPnlss(const std::vector<PnlssStart>& starts, const std::vector<InputOutputRecord>& estimation,
                  const std::vector<InputOutputRecord>& validation, const PnlssFitOptions& = {}, const Progress& = {});

}  // namespace excursion
