// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/Diagnosis.h"
#include "Engine/Estimate/Record.h"
#include "Engine/Loudspeaker/Fit.h"

#include <string>
#include <vector>

namespace excursion {

struct DiagnoseOptions {
    FitOptions fit;
    int trials = 4;                 ///< candidates that are confirmed by a refit
    double significantFall = 0.02;  ///< smallest significant relative fall of chiSquaredPerValue on validation data
    bool isValid(std::string* reason) const;
};

struct Step;

/// An effect as predicted by a score test, not tried yet.
struct Score;
RankedEffect promisedBy(const Score&);

/// Finds what a model lacks, in two steps. (1) A score test of every effect in the catalogue that the model does not
/// have: the residual is projected on the sensitivities to the effect's parameters, after the model's own parameters
/// have explained what they can. (2) A refit with the best few, judged on validation data. The model must have been
/// fitted to the record.
/// @param before  the model compared with the record, with spectra (compare())
Diagnosis diagnose(const Model&, const Record&, const Comparison& before, const DiagnoseOptions& = {},
                   const Progress& = {});

/// The same for a take that is only a frequency response: the linear effects compete.
Diagnosis diagnose(const Model&, const Spectra&, const Comparison& before, const DiagnoseOptions& = {},
                   const Progress& = {});

/// Adds what the check of the take has found. Where the rest of the cone jumps, what does not repeat is no noise:
/// nothing is complete then.
void tell(Diagnosis&, const std::vector<Problem>&);

/// Updates such a diagnosis of the model if the step's effect is known to be missing, because other missing effects
/// have shown it. The effect comes first, with the step's model if that leaves less.
void nameNext(Diagnosis&, const Model&, const Spectra&, const Comparison& before, const Step&);

}  // namespace excursion
