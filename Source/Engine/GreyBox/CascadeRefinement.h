// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/PartialFractionFit.h"

namespace excursion {

/// Two models in series, refined together: X = M(s) of the voltage, and P = s^2 K(s) X, both measured, to the maximum
/// of their likelihood
///     minimize  sum |M - X|^2/deviation_x^2 + |s^2 K M - P|^2/deviation_p^2
/// over the poles and coefficients of M and K, by search() with an analytic Jacobian. Refining one after the other
/// would creep: what M has too much K can have too little, and only X tells.
struct CascadeRefinement : SearchSummary {
    PartialFractionFit first, second;  ///< their costs are not kept up; finalCost is the sum above
};

/// @param first, second  stable, of continuous time, one input and output; the relative degree of the first is kept,
/// and has to be at least 2
/// @param between, after  X and P at the same frequencies, with deviations
/// Throws Error (usage) for options, models or data that do not fit.
CascadeRefinement refineCascade(const PartialFractionFit& first, const PartialFractionFit& second,
                                const FrequencyData& between, const FrequencyData& after,
                                const PoleRefinementOptions& = {});

}  // namespace excursion
