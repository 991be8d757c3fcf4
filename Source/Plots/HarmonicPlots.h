// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plots/Plot.h"

#include <string>
#include <vector>

namespace excursion {

/// One line of a picture of harmonics: dB re the fundamental, a NaN where it is not known.
struct HarmonicLine {
    int order = 2;
    std::vector<double> db;
};

/// The harmonics of a channel at a level over the frequency of the fundamental, with their total and what noise may
/// look like.
Plot harmonicPlot(const std::string& title, const std::vector<double>& frequency,
                  const std::vector<HarmonicLine>& harmonics, const std::vector<double>& totalDb,
                  const std::vector<double>& floorDb);

}  // namespace excursion
