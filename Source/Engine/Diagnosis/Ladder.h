// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/Diagnose.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/Model.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// One step of the ladder: an effect was added (none at the first), and everything was refitted.
struct Rung {
    std::string added;                            ///< effect id; empty at the start
    std::map<Quantity, double> predictedErrorDb;  ///< from the diagnosis that proposed it
    Comparison comparison;                        ///< after the fit, on validation data
    Diagnosis diagnosis;                          ///< of this rung's model: what to add next, or why to stop
    Model model;
    FitSummary fit;
};

struct Ladder {
    Verdict verdict = Verdict::unknownEffect;
    std::string sentence;
    std::vector<Rung> rungs;
    std::vector<Problem> problems;
    /// effects that were tried and removed, because they left as much as they explained
    std::vector<std::string> withdrawn;

    const Model& model() const { return rungs.back().model; }
};

/// The first part of a verdict: an effect of the last model.
struct KnownEffect {
    std::string effect;                ///< id
    std::optional<double> confidence;  ///< from the diagnosis that proposed it; none if it was added by hand
};
std::vector<KnownEffect> knownEffects(const Ladder&);

/// "Found: Stiffness K(x) and Force factor Bl(x). " Empty if the ladder found nothing.
std::string foundInWords(const Ladder&);

}  // namespace excursion
