// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Sums.h"
#include "Engine/Diagnosis/Vote.h"
#include "Engine/Loudspeaker/Model.h"
#include "Engine/Estimate/Record.h"

#include <map>
#include <vector>

namespace excursion {

/// The result of the score test for one effect: the model with the effect, moved by one Gauss-Newton step on the
/// estimation sections, and the predicted result of that step on the validation sections.
struct Score {
    const Effect* effect = nullptr;
    Model model;
    /// for a linear effect: the model found by a search on the frequency responses; without components if none was made
    Model byResponse;
    double chiSquaredPerValue = 0.0;     ///< predicted, all channels
    Vote vote;                           ///< with all candidates at once; none without periods
    std::map<Quantity, double> errorDb;  ///< predicted, by channel
};

struct ScoreResult {
    double chiSquaredPerValue = 0.0;  ///< of the model without a step, on the validation sections
    /// by channel of the record: without a step, and predicted with all candidates at once
    std::vector<double> chiSquaredPerValueByChannel, togetherChiSquaredPerValue;
    std::vector<Score> scores;  ///< one per effect, with its best start, lowest chiSquaredPerValue first
};

/// Score (Lagrange multiplier) test of every applicable effect in the catalogue that the model lacks. All are added at
/// zero strength. One run (differentiate) gives the sensitivities to every strength and to the model's own parameters,
/// and
///     d = argmin |r + J d|^2   over the model's parameters and the effect's strengths
/// predicts the residual r + J d. All levels, channels and sections count, weighted by their noise.
ScoreResult score(const Model&, const Record&, const ScoreOptions&, const Progress& = {});

}  // namespace excursion
