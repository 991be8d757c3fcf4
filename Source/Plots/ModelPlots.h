// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/StateSpace.h"
#include "Plots/Plot.h"

#include <vector>

namespace excursion {

/// The pictures of a linear model, of whole or of fractional order: of continuous time in lambda = s^alpha, or of
/// discrete time (alpha 1).

/// Poles and zeros by what a person knows them by: frequency |s|/(2 pi) and angle |arg lambda|, with the border of
/// stability at alpha 90 degrees (Matignon's sector; of whole orders the imaginary axis). What lies above is stable. Of
/// discrete time s = fs ln z.
Plot rootsPlot(const StateSpace&, double alpha = 1.0);

/// 20 log10 |G| over the complex plane [B appendix D], cut along rays s = r exp(j theta) from the frequency axis,
/// theta = 90 degrees, to the negative real one: the first cut is the frequency response. One input, one output: the
/// first of each.
Plot gainSurfacePlot(const StateSpace&, double alpha = 1.0);

/// Errors against the order of a sweep, dB; a NaN is left out.
struct ErrorsByOrder {
    std::vector<double> order, error, weighted, validation;
};
Plot orderPlot(const ErrorsByOrder&);

}  // namespace excursion
