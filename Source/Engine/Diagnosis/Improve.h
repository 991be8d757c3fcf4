// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Diagnose.h"

#include <functional>
#include <string>
#include <vector>

namespace excursion {

/// One step of the ladder: an effect was added (none at the first), everything was refitted.
struct Rung {
    std::string added;                              ///< effect id; empty at the start
    std::map<Quantity, double> predictedErrorDb;    ///< by the diagnosis that proposed it
    Comparison comparison;                          ///< after the fit, on validation data
    Diagnosis diagnosis;                            ///< of this rung's model: what to add next, or why to stop
    Model model;
    FitSummary fit;
};

struct Ladder {
    Verdict verdict = Verdict::unknownEffect;
    std::string sentence;
    std::vector<Rung> rungs;
    std::vector<Problem> problems;
    std::vector<std::string> withdrawn;   ///< effects that were tried and taken back, as what they left was as large as what they explained

    const Model& model() const { return rungs.back().model; }
};

struct ImproveOptions {
    DiagnoseOptions diagnose;
    std::vector<std::string> with;   ///< effects that the first model has already
    int maximumRungs = 8;
    std::function<void(const Rung&)> finished;   ///< called with each rung once its diagnosis is known; may be empty
};

/// Fits the base (with `with`), then diagnoses and adds until the verdict is no longer missing-effect. A take with a fatal
/// problem gives bad-measurement and no rung.
Ladder improve(const Take&, const ImproveOptions& = {}, const Progress& = {});

/// The fit that `add` and `excursion fit` make: the named effects on the base, laws expanded as far as the data asks for.
/// @param record  is adapted to the model
Model fitEffects(Record& record, const std::vector<std::string>& effects, const FitOptions&, FitSummary* = nullptr,
                 const Progress& = {});
Model fitEffects(const Spectra&, const std::vector<std::string>& effects, FitSummary* = nullptr);

} // namespace excursion
