// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Batch/Collection.h"
#include "Plots/Plot.h"

namespace excursion {

/// A quantity over the units in their order, with the 95 % of its standard errors, the median, the limits and those
/// that lie off.
Plot quantityPlot(const Collection&, const Quantities&);

/// A law of every unit: the golden one and the outliers stand out.
Plot lawsPlot(const Collection&, const LawsOfUnits&);

}  // namespace excursion
