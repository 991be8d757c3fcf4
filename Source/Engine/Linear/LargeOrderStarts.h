// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/IdentifyOptions.h"

#include <string>
#include <vector>

namespace excursion {

/// Poles that a refinement may start from.
struct PoleStart {
    std::string name;
    PartialFractionFit fit;
};

/// The scale of sections for these data: 1 in discrete time, else the end of the band.
double sectionScaleOf(const FrequencyData&, const IdentifyOptions&);

/// Rates of the bilinear transform that put the band's end at different places of the unit circle, and its middle for
/// wide bands.
std::vector<double> warpingRates(const FrequencyData&, bool thorough);

/// Whether a fit explains all but noise: its cost lies below `floor`, or its residual is white.
bool explainsAllButNoise(const PartialFractionFit&, const FrequencyData&, double floor);

/// Starts for an order at which each of them costs something: one after the other, each refined by a few steps, until
/// one explains all but noise. Where its refinement then ends soon, the data determines that many poles and no other
/// start could end elsewhere. Where it goes on, the order is above the true one and poles follow the noise; then vector
/// fitting has a try, too, as there are many minima, but hardly different ones.
///
/// The subspace method goes first. One range of its observability matrix holds the models of all orders, so the larger
/// models to prune come from the same ranges; of them only the poles are taken, as the coefficients follow from those.
/// Vector fitting is relocated until it settles, and its best poles are kept, as its error does not fall at every step.
/// Poles of a larger model are pruned one section after the other, refined where that has cost anything.
/// @param floor  the cost that noise alone would leave, see PartialFractionFit
std::vector<PoleStart> startsOfLargeOrder(const FrequencyData&, const IdentifyOptions&, double floor,
                                          const Progress& = {});

}  // namespace excursion
