// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Design/WhatIf.h"
#include "Engine/Diagnosis/Ladder.h"
#include "Engine/Loudspeaker/FitResponse.h"
#include "Plots/Plot.h"

#include <string>
#include <vector>

namespace excursion {

/// The pictures of a diagnosis, as descriptions that the report draws and the window draws.

/// Measured, model, error and noise of a channel against frequency, dB.
Plot spectrumPlot(const ErrorSpectrum&, const std::string& unit);

/// The errors of the other rungs of a ladder into the picture of one rung's channel at a level. The lines of a role
/// differ in their dashes, and the key names the rungs.
void overlayErrors(Plot&, const Ladder&, std::size_t shown, std::size_t channel, std::size_t level);

/// What the balances of force and voltage lack against motion, and what the sections lack of stiffness and resistance
/// against the time; `after` may be null.
std::vector<Plot> residualPlots(const Comparison& before, const Comparison* after);

/// What each effect of a model is by itself, with its 95 % band: Bl(x), K(x), ..., a hysteresis loop, the drift of Re,
/// the lateness of the sound. An effect that only changes a response has no picture of its own.
std::vector<Plot> effectPlots(const Model&);

/// How a channel's error fell from rung to rung.
Plot fallPlot(const Ladder&, Quantity);

/// Distortion of each channel against frequency: of the whole model, and of the four effects that alone make most.
std::vector<Plot> distortionPlots(const DistortionByEffect&);

/// Measured frequency responses with those of the first and the last model.
std::vector<Plot> responsePlots(const Ladder&, const std::vector<ResponseTarget>&);

}  // namespace excursion
