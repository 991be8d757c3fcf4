// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Fractional/FractionalOptions.h"
#include "Engine/Fractional/FractionalStateSpace.h"
#include "Engine/Linear/FrequencyData.h"

#include <string>
#include <vector>

namespace excursion {

/// V of the best model at one alpha.
struct AlphaChiSquared {
    double alpha = 0.0, chiSquared = 0.0;
};

struct FractionalIdentification {
    FractionalStateSpace model;
    /// standard error of alpha; 0 where alpha was given, NaN where it is not determined, as `warning` says
    double alphaStandardError = 0.0;
    /// as of LinearIdentification; chiSquared NaN without deviations
    double cost = 0.0, errorDb = 0.0, chiSquared = 0.0;
    double sectorMargin = 0.0;  ///< rad
    bool stable = false;
    std::string start;
    SearchSummary refinement;
    /// of the search for alpha, ascending; V relative to what is left where deviations are not known
    std::vector<AlphaChiSquared> curve;
    /// a sentence where alpha is not determined: another alpha does as well, or the curve is flat; else empty
    std::string warning;
};

/// Identification of a commensurate fractional model from a frequency response [B 5.3]: that of Engine/Linear in
/// lambda = s^alpha, on lambda_k = (j w_k)^alpha. [B 5.3] takes powers of lambda_k and no weights, and finds models
/// that are unstable; here the lines are weighted by their standard deviation, the polynomials are orthonormal on them,
/// the start is refined to maximum likelihood, and its poles stay out of Matignon's sector.
///
/// With alpha free, the likelihood with everything else at its best is a curve in alpha alone: V(alpha) = sum
/// |e|^2/sigma^2 = -ln L. It is searched on a grid, each point with starts of its own, then by golden section about the
/// lowest point, with poles carried from one alpha to the next as lambda^(alpha'/alpha). Its curvature is Fisher's
/// information, taken from the Jacobian: deviation = (d2V/dalpha2)^(-1/2). Where the model leaves more than the noise,
/// or no standard deviations are known, the noise is what is left, over K - P/2 complex values of P parameters.
///
/// Throws Error (usage, data, numerical) as identify() does, and for an alpha or a search outside of (0, 2).
FractionalIdentification identifyFractional(const FrequencyData&, const FractionalOptions&, const Progress& = {});

/// The same for several orders. Order and alpha trade for one another [B 5.5]: many poles imitate any power of s.
struct FractionalSweep {
    struct Entry {
        int order = 0;
        FractionalIdentification found;
        double mdl = 0.0;  ///< as OrderSweep's, a free alpha counted as a parameter
    };
    std::vector<Entry> entries;  ///< by ascending order
    std::size_t chosen = 0;      ///< the lowest MDL
    std::string sentence;        ///< why that one
    /// a sentence where another order explains the data as well with another alpha; else empty
    std::string warning;
};

/// @param orders  ascending
FractionalSweep sweepFractional(const FrequencyData&, const std::vector<int>& orders, const FractionalOptions&,
                                const Progress& = {});

}  // namespace excursion
