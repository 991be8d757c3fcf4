// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Driver/Model.h"
#include "Engine/Driver/OutputError.h"
#include "Engine/Driver/Record.h"

#include <map>
#include <vector>

namespace excursion {

/// What the score test says of one effect: the model with it, moved by one Gauss-Newton step on the estimation sections, and what
/// that step promises on the validation sections.
struct Score {
    const Effect* effect = nullptr;
    Model model;
    Model byResponse;                          ///< of a linear effect: as a search on the frequency responses found it; without components when none was made
    double chi = 0.0;                          ///< predicted, all channels
    double uniqueDb = 0.0;                     ///< by how much all candidates together would leave more without this one: what it alone explains. 0 without periods
    double inconsistency = 0.0;                ///< how much more it would explain with strengths of its own at each level, as a share of that: a law is
                                               ///< the same at all levels, what is bent to stand for something else is not
    std::map<Quantity, double> errorDb;        ///< predicted, by channel
};

struct ScoreOptions {
    int substeps = 1;
    unsigned threads = 2;
    int degree = 6;      ///< of the laws that are tried
};

struct ScoreResult {
    double chi = 0.0;            ///< of the model as it is, on the validation sections
    std::vector<double> chiByChannel, togetherChi;   ///< by channel of the record: as it is, and predicted with all candidates at once
    std::vector<Score> scores;   ///< one an effect, best start each, lowest chi first
};

/// Score (Lagrange multiplier) test of every applicable effect of the catalogue that the model lacks: all are put in at zero strength,
/// one run (differentiate) gives the sensitivities to every strength besides those to the model's own parameters, and
///     d = argmin |r + J d|^2   over the model's parameters and the effect's strengths
/// predicts the residual r + J d. Levels, channels and sections all count, weighted by their noise.
ScoreResult score(const Model&, const Record&, const ScoreOptions&, const Progress& = {});

/// Raises the degree of the model's laws by `by` where the same test says that the new coefficients pay for themselves; returns
/// the effects that were raised. The new coefficients start at zero.
std::vector<std::string> raiseDegrees(Model&, const Record&, const ScoreOptions&, int by = 4);

} // namespace excursion
