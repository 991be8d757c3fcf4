// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/Frf.h"
#include "Engine/Linear/StateSpace.h"
#include "Plots/Plot.h"

#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// The pictures of an identification: a measured response against that of a model.

/// Magnitudes in dB re 1 `unit`: measured, model, what is left of |measured - model|, and where they are known the
/// measured response's standard deviations. Both on the same frequencies.
Plot gainPlot(const Frf& measured, const Frf& model, const std::string& unit);

/// Phases, degrees, within +-180; a line is interrupted where it wraps.
Plot phasePlot(const Frf& measured, const Frf& model);

/// Poles and zeros in the complex plane with the border of stability: of discrete time z and the unit circle, of
/// continuous time lambda = s^alpha in (1000 rad/s)^alpha and Matignon's rays, arg lambda = +-alpha pi/2.
Plot rootsPlanePlot(const StateSpace&, double alpha = 1.0);

/// How an error fell, dB, after each step of a fit, and the noise where it is known.
Plot stepsPlot(const std::vector<double>& history, const std::optional<double>& noiseDb);

}  // namespace excursion
