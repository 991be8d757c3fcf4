// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/PartialFractionFit.h"

namespace excursion {

/// Whether what a fit leaves has anything that neighbouring lines share. A pole that is missing bends the residual over
/// several lines, noise does not; so this tells that nothing is left to be explained without knowing the noise's size.
///
/// With the weighted residuals r_k of an output on K lines,
///     T = K sum_{l=1}^{5} |rho_l|^2,   rho_l = sum_k r_k conj(r_{k+l}) / sum_k |r_k|^2,
/// is a sum of five exponential variables of mean 1 where they are white (Box & Pierce 1970, for complex values). A fit
/// of order n takes at most n of K values out of its residual, which correlates what stays by n/K at most. White is
///     T <= 15 + 5 n^2/K
/// for every output: noise alone passes 999 times of 1000. Noise that is not independent from line to line never does,
/// and fewer than four lines a pole are too few to say; then the answer is no.
bool leavesWhiteNoise(const PartialFractionFit&, const FrequencyData&);

}  // namespace excursion
