// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Sums.h"

#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace excursion {

/// The evidence of a whole catalogue, or a whole model, on one of its effects.
struct Vote {
    /// how much more all others together would leave without it, in the most informative channel: what it alone
    /// explains
    double uniqueDb = 0.0;
    /// how much more it would explain with separate strengths at each level, relative to that. A law is the same at all
    /// levels; an effect that stands for something else is not. NaN of one level, which cannot tell
    double inconsistency = 0.0;
    double byLevel = 0.0;  ///< the same, relative to the cost

    /// Whether the others explain clearly less without it, and its strength is about the same at all levels.
    bool backs() const { return uniqueDb >= 0.5 && !(inconsistency >= 0.5); }
    /// Whether it explains what nothing else does, no matter what else is missing. Of one level it must explain more.
    bool standsAlone() const
    {
        return std::isnan(inconsistency) ? uniqueDb >= 6.0 : uniqueDb >= 3.0 && inconsistency < 0.2;
    }
};

/// @param together   places of the parameters that may change
/// @param strengths  places of the effect's strengths among them
/// @param away       the step of all parameters that takes just these strengths to zero: none for an effect with zero
///                   strength
Vote voteOn(const Sums&, const std::vector<Eigen::Index>& together, std::vector<Eigen::Index> strengths,
            const Eigen::VectorXd& away, bool noiseKnown);

/// The vote of a model, fitted to a record with periods, on each of its effects.
std::map<std::string, Vote> votesOf(const Model&, const Record&, const ScoreOptions&, const Progress& = {});

}  // namespace excursion
