// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plots/Plot.h"
#include "Study/Summary.h"

namespace excursion::study {

/// Of the effects that were added with about the same confidence, the share that is there: with the 95 % interval that
/// so few of them leave (Wilson, J. Am. Stat. Assoc. 22, 1927), beside the line on which a share is what was claimed.
Plot calibrationPlot(const Calibration&);

}  // namespace excursion::study
