// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Sums.h"
#include "Engine/Diagnosis/Vote.h"
#include "Engine/Loudspeaker/Model.h"
#include "Engine/Loudspeaker/Record.h"

#include <map>
#include <vector>

namespace excursion {

/// What the score test says of one effect: the model with it, moved by one Gauss-Newton step on the estimation
/// sections, and what that step promises on the validation sections.
struct Score {
    const Effect* effect = nullptr;
    Model model;
    /// of a linear effect: as a search on the frequency responses found it; without components when none was made
    Model byResponse;
    double chiSquaredPerValue = 0.0;     ///< predicted, all channels
    Vote vote;                           ///< of all candidates at once; none without periods
    std::map<Quantity, double> errorDb;  ///< predicted, by channel
};

struct ScoreResult {
    double chiSquaredPerValue = 0.0;  ///< of the model as it is, on the validation sections
    /// by channel of the record: as it is, and predicted with all candidates at once
    std::vector<double> chiSquaredPerValueByChannel, togetherChiSquaredPerValue;
    std::vector<Score> scores;  ///< one an effect, best start each, lowest chiSquaredPerValue first
};

/// Score (Lagrange multiplier) test of every applicable effect of the catalogue that the model lacks: all are put in at
/// zero strength, one run (differentiate) gives the sensitivities to every strength besides those to the model's own
/// parameters, and
///     d = argmin |r + J d|^2   over the model's parameters and the effect's strengths
/// predicts the residual r + J d. Levels, channels and sections all count, weighted by their noise.
ScoreResult score(const Model&, const Record&, const ScoreOptions&, const Progress& = {});

}  // namespace excursion
