// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Estimate/Record.h"
#include "Engine/Numerics/LeastSquares.h"

#include <string>
#include <vector>

namespace excursion {

struct FitOptions {
    LeastSquaresOptions search;
    /// relative accuracy of the integration; 0: a seventh of the noise, at most 1e-4
    double simulationTolerance = 0.0;
    int substeps = 0;  ///< integration steps per sample; 0: chosen from the tolerance
    unsigned threads = 2;
    /// steps a sample of the sensitivities; 0: as few as are stable. More make iterations slower, but fewer if some
    /// directions are poorly determined
    int gradientSubsteps = 0;
    /// sensitivities of fed laws around an exact simulation (playedError()): iterations take a tenth of the time, but a
    /// few more are needed
    bool fedGradient = false;
    /// unless `fed`, and where canCorrect(): steps are corrected by the slopes of their begin (KeptSlopes.h), which
    /// leads further along the bent valleys at whose end the last digits are
    bool corrected = false;
    bool fed = false;  ///< feed the laws the motion that the take shows (FeedbackError.h) instead of simulating: fast
                       ///< and nearly as good, for starts and trials; a take without periods is simulated all the same

    /// What is free is the caller's choice. Otherwise sensors are free where the record tells them (freeSensors()), and Rms
    /// is held where, without a current channel, only laws could tell it from the coil's damping and the model has
    /// none.
    bool asGiven = false;
    bool sectionsDrift = false;  ///< as if the record said so (Record::sectionsDrift)

    bool isValid(std::string* reason) const;
};

struct FitSummary : SearchSummary {
    int substeps = 0;
    double chiSquaredPerValue = 0.0;  ///< 1 if only noise is left
    bool onlyNoise = false;           ///< no channel's error is above its noise
};

/// The range that the take visits: the peaks of displacement, velocity and current, measured if a channel gives them,
/// else simulated by the model, and the excited band.
OperatingRange visitedRange(const Model&, const Record&, int degree = 6);

/// Output-error fit of all free parameters,
///     min sum_{sections, channels, lines} |Y_model - Y_measured|^2 / sigma^2,
/// by Levenberg-Marquardt with automatic derivatives of the simulation. Leaves standard errors and the covariance in
/// the model; if the residuals exceed the noise, both are scaled up accordingly. Standard errors grow further where
/// bands disagree (overdispersionOf()). What is free and not told has none.
FitSummary fit(Model&, const Record&, const std::vector<std::size_t>& sections, const FitOptions& = {},
               const Progress& = {});

/// Whether a fit can correct its steps here: a record with periods whose slopes are few enough to be kept (256 MiB).
bool canCorrect(const Model&, const Record&, const std::vector<std::size_t>& sections);

/// Whether an effect with a slow memory is at work, which drifts in the course of a take.
bool warms(const Model&);

/// Makes a record ready for models near this linear one: periodic sections start settled (the lead-in lasts until the
/// resonance has decayed by 110 dB), and the input sensor's noise counts as noise of the outputs,
///     sigma^2 += |G|^2 sigma_u^2  on the lines that are played.
/// What a model that warms follows is no noise to it (takeDriftOutOfNoise()).
void adapt(Record&, const Model&);

/// Steps per sample for simulating this model on this record; tolerance as FitOptions::simulationTolerance.
int substepsFor(const Model&, const Record&, double tolerance = 0.0);

/// Start values, path, and the first linear fit of a take in the time domain.
Model startModel(const Record&);

}  // namespace excursion
