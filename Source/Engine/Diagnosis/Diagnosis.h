// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/TakeCheck.h"
#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/Remainder.h"
#include "Engine/Diagnosis/Vote.h"
#include "Engine/Loudspeaker/Model.h"

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace excursion {

enum class Verdict {
    unknownEffect,  ///< something is left that no effect in the catalogue explains
    missingEffect,  ///< the first effect of the ranking is missing
    complete,       ///< only noise is left
    badMeasurement  ///< the take is at fault
};
std::string_view name(Verdict);  ///< "missing-effect", as in the files

/// One effect that may be missing.
struct RankedEffect {
    std::string effect;                           ///< id
    double confidence = 0.0;                      ///< 0..1
    std::map<Quantity, double> predictedErrorDb;  ///< from the score test
    std::map<Quantity, double> confirmedErrorDb;  ///< after a refit, on validation data; empty if not tried
    double predictedChiSquaredPerValue = 0.0;
    double confirmedChiSquaredPerValue = 0.0;  ///< 0 if not tried
    Vote vote;                                 ///< from the catalogue as a whole; none for a frequency response
    bool significant = false;                  ///< the improvement justifies its parameters
    std::string reason;                        ///< one sentence that the user can check on a plot
    Model model;                               ///< with the effect, refitted; without components if not tried
};

struct Diagnosis {
    Verdict verdict = Verdict::unknownEffect;
    std::string sentence;                        ///< the verdict in words
    ErrorByChannel error;                        ///< of the given model
    std::vector<RankedEffect> ranking;           ///< best first
    std::vector<std::string> indistinguishable;  ///< effects that this take cannot distinguish from the first
    std::string measureNext;                     ///< what to measure to distinguish them
    Remainder remainder;                         ///< what the given model leaves unexplained
    std::vector<Problem> problems;               ///< of the take

    const RankedEffect* find(std::string_view effect) const;  ///< in the ranking; null if it is not there
};

}  // namespace excursion
