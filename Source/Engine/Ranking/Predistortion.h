// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Progress.h"
#include "Engine/Ranking/RankedModel.h"

#include <optional>
#include <string>

namespace excursion {

/// What it is worth to invert a fitted class on the take. The model plays the stimulus of its fit, as it is and
/// predistorted, and is held against its linear part: beforeDb and modelDb. On the take what the model does not explain
/// stays as well:
///     10^(leftDb/10) = 10^(modelDb/10) + max(10^(errorDb/10) - N, 0.1 N),  N = 10^(noiseDb/10) where it is known, else
///     0
/// as an error that is the noise's could still be a tenth of it.
/// @param model  a fitted one with its document, stimulus and errors
/// @param output quantity, "displacement"
/// @returns one with trouble, one sentence, where the class cannot be inverted, where less than 3 dB
/// would go, or where what it is to make linear is not what it makes linear. Throws Error (cancelled).
RankedPredistortion predistortionOf(const RankedModel& model, const std::string& output, double sampleRate,
                                    std::optional<double> noiseDb, const Progress& = {});

}  // namespace excursion
