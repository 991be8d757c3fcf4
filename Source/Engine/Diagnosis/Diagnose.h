// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/TakeCheck.h"
#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/Remainder.h"
#include "Engine/Diagnosis/Vote.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/Model.h"
#include "Engine/Loudspeaker/Record.h"

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace excursion {

enum class Verdict {
    unknownEffect,  ///< something is left that no effect of the catalogue explains
    missingEffect,  ///< the first of the ranking is missing
    complete,       ///< only noise is left
    badMeasurement  ///< the take is at fault
};
std::string_view name(Verdict);  ///< "missing-effect", as in the files

/// One effect that could be what is missing.
struct RankedEffect {
    std::string effect;                           ///< id
    double confidence = 0.0;                      ///< 0..1
    std::map<Quantity, double> predictedErrorDb;  ///< from the score test
    std::map<Quantity, double> confirmedErrorDb;  ///< after a refit, on validation data; empty when not tried
    double predictedChiSquaredPerValue = 0.0;
    double confirmedChiSquaredPerValue = 0.0;  ///< 0 when not tried
    Vote vote;                                 ///< of the catalogue as a whole; none of a frequency response
    bool significant = false;                  ///< it pays for its parameters
    std::string reason;                        ///< one sentence that a person can check on a plot
    Model model;                               ///< with the effect, as refitted; without components when not tried
};

struct Diagnosis {
    Verdict verdict = Verdict::unknownEffect;
    std::string sentence;                        ///< the verdict in words
    ErrorByChannel error;                        ///< of the model as it was given
    std::vector<RankedEffect> ranking;           ///< best first
    std::vector<std::string> indistinguishable;  ///< effects that this take cannot tell from the first
    std::string measureNext;                     ///< what would tell them apart
    Remainder remainder;                         ///< what the model as it was given leaves
    std::vector<Problem> problems;               ///< of the take

    const RankedEffect* find(std::string_view effect) const;  ///< of the ranking; null when it is not there
};

struct DiagnoseOptions {
    FitOptions fit;
    int trials = 4;                 ///< candidates that are confirmed by a refit
    double significantFall = 0.02;  ///< smallest relative fall of chiSquaredPerValue on validation data that counts
    bool isValid(std::string* reason) const;
};

struct Step;

/// An effect as a score test promises it, not tried yet.
struct Score;
RankedEffect promisedBy(const Score&);

/// What a model lacks, by (1) a score test of every effect of the catalogue that it does not have: the residual is
/// projected on the sensitivities to the effect's parameters, after the model's own have taken what they can; (2) a
/// refit with the best few, judged on validation data. The model must have been fitted to the record.
Diagnosis diagnose(const Model&, const Record&, const DiagnoseOptions& = {}, const Progress& = {});

/// The same for a take that is a frequency response only: the linear effects compete.
Diagnosis diagnose(const Model&, const Spectra&, const DiagnoseOptions& = {}, const Progress& = {});

/// Says again what such a diagnosis of the model comes to when the step's effect is known to be missing, as others that
/// are missing too have shown: it comes first, with the step's model where that leaves less.
void nameNext(Diagnosis&, const Model&, const Spectra&, const Step&);

}  // namespace excursion
