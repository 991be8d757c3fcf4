// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/FractionalPnlss/FractionalPnlss.h"
#include "Engine/Polynomial/Pnlss/PnlssFit.h"

namespace excursion {

struct FractionalPnlssOptions {
    int maximumIterations = 50;
    double costTolerance = 1e-5;  ///< as PnlssFitOptions; an iteration takes longer here
    double rankTolerance = 1e-13;
    bool linearFree = true;  ///< A, B, C, D move too
    bool alphaFree = true;   ///< alpha moves too

    bool isValid(std::string* reason = nullptr) const;
};

/// What became of a fit, and how it ended; costs are relative squared errors.
struct FractionalPnlssFit : SearchSummary {
    FractionalPnlss model;
    /// standard error of alpha, what is left taken for white noise; 0 where alpha was given
    double alphaStandardError = 0.0;
    /// relative rms error [B 4.26] of the model that is returned; validation NaN without records
    double estimationDb = 0.0, validationDb = 0.0;
    bool stable = false;          ///< the linear part on the grid is stable, and no record made the model run away
    std::vector<double> history;  ///< relative rms error in dB on the estimation records after each accepted step
};

/// As relativeErrorDb() of a PNLSS model, on a grid.
double relativeErrorDb(const FractionalPnlss&, const FractionalGrid&, const std::vector<InputOutputRecord>&);

/// Identification of the fractional polynomial model in the time domain, which [B 7.2] leaves to the future: the
/// simulation error of the ladder realization is lowered as that of a PNLSS model is (see fitPnlss), with the exact
/// Jacobian, by alpha too. Records start from rest; `skip` lets the transient die. Where there are validation records
/// the model with the least error on them is returned. Throws Error (usage, data) for options, a model or records that
/// do not fit.
FractionalPnlssFit fitFractionalPnlss(const FractionalPnlss& start, const FractionalGrid&,
                                      const std::vector<InputOutputRecord>& estimation,
                                      const std::vector<InputOutputRecord>& validation,
                                      const FractionalPnlssOptions& = {}, const Progress& = {});

}  // namespace excursion
