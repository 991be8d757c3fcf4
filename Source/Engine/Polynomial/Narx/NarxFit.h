// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/Narx/Narx.h"
#include "Engine/Polynomial/Pnlss/PnlssFit.h"

#include <string>
#include <vector>

namespace excursion {

struct NarxFitOptions {
    int outputLags = 2, inputLags = 2;  ///< na, nb
    /// of the monomials that are tried: all of degree 1 .. degree, at most 1000
    int degree = 3;
    bool direct = true;          ///< u(t) may act at once
    bool constant = true;        ///< a constant is tried, too
    int maximumTerms = 50;       ///< chosen, one after the other
    int maximumIterations = 50;  ///< of the refinement; 0: none

    bool isValid(std::string* reason = nullptr) const;
};

/// What one more term explains.
struct NarxStep {
    Eigen::RowVectorXi exponents;  ///< of the term, as in Narx
    /// share of the output's power that it explains one step ahead, beside those before it (Billings)
    double errorReduction = 0.0;
    /// of a simulation with the terms so far, on the validation records; +infinity: runs away
    double simulationDb = 0.0;
};

/// What became of a fit, and how the refinement that gave the model ended; costs are relative squared errors.
struct NarxFit : SearchSummary {
    Narx model;
    /// in the order in which terms were chosen; the model has the first of them
    std::vector<NarxStep> steps;
    /// relative rms error of a simulation [B 4.26]; validation NaN without records
    double estimationDb = 0.0, validationDb = 0.0;
    bool stable = false;  ///< around rest, and no record made it run away
};

/// Orthogonal least squares with forward selection (Chen, Billings & Luo 1989): among all monomials the one that lowers
/// the error of a prediction one step ahead the most is taken, then the next beside it, all on the triangular factor of
/// [regressors, output], which holds all their products. A prediction flatters: it hides errors in its measured past.
/// So the number of terms is judged by simulations of the validation records (without any: of the estimation records):
/// the best one, and with validation records some others, are refined on the simulation error by search(), which also
/// takes away the bias that noise in the past outputs makes, and the model with the least error on them is returned.
/// Throws Error (usage, data) for options or records that make no sense, (numerical) where all simulations run away.
NarxFit fitNarx(double sampleRate, const std::vector<InputOutputRecord>& estimation,
                const std::vector<InputOutputRecord>& validation, const NarxFitOptions& = {}, const Progress& = {});

}  // namespace excursion
