// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/PreparedTake.h"
#include "Engine/Diagnosis/Ladder.h"
#include "Engine/Progress.h"

#include <Eigen/Core>

#include <functional>
#include <string>
#include <vector>

namespace excursion {

/// Which physical laws a model without physics agrees with.
struct AgreedLaws {
    std::vector<std::string> effects;  ///< that the physical driver needed to move as the model does
    /// relative error of the driver without effects against the model, on validation sections
    double baseDb = 0.0;
    double leftDb = 0.0;  ///< the same with these effects
    std::string sentence;
};

/// The model plays the take in the loudspeaker's place, and is diagnosed as one. So what a PNLSS model has found is
/// said in the words of the catalogue (from 4.12 back to what it was expanded from).
struct Agreement : AgreedLaws {
    Ladder ladder;  ///< of the take as the model plays it
};

/// @param play  the output, N x 1, for an input of N samples, N x 1, from rest
/// @param output  the channel that the model explains
/// What the periods of the take scatter is added to what the model plays, so the diagnosis knows how far to trust it.
/// Throws Error (data) where the take lacks the channel or is not fit for use, (numerical) where the model runs away.
Agreement agreement(const PreparedTake&, Quantity output,
                    const std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>& play, const Progress& = {});

}  // namespace excursion
