// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Sums.h"

#include <map>
#include <string>
#include <vector>

namespace excursion {

/// What a whole catalogue, or a whole model, says of one of its effects.
struct Vote {
    /// by how much all others together would leave more without it, in the channel that tells most: what it alone
    /// explains
    double uniqueDb = 0.0;
    /// how much more it would explain with strengths of its own at each level, as a share of that: a law is the same at
    /// all levels, what is bent to stand for something else is not
    double inconsistency = 0.0;
    double byLevel = 0.0;  ///< how much more, of the cost

    /// Whether the others explain clearly less without it, and it is about the same at all levels.
    bool backs() const { return uniqueDb >= 0.5 && inconsistency < 0.5; }
    /// Whether it explains what nothing else does, whatever else is missing.
    bool standsAlone() const { return uniqueDb >= 3.0 && inconsistency < 0.2; }
};

/// @param together   places of the parameters that may all be moved
/// @param strengths  of these, the effect's strengths
/// @param away       the step of all parameters that takes just these strengths to zero: none for an effect that is not
/// at work yet
Vote voteOn(const Sums&, const std::vector<Eigen::Index>& together, std::vector<Eigen::Index> strengths,
            const Eigen::VectorXd& away, bool noiseKnown);

/// The vote of a model, fitted to a record with periods, on each of its effects.
std::map<std::string, Vote> votesOf(const Model&, const Record&, const ScoreOptions&, const Progress& = {});

}  // namespace excursion
