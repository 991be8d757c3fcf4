// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/FrequencyData.h"
#include "Engine/Linear/SecondOrderSections.h"
#include "Engine/Numerics/Search.h"
#include "Engine/Progress.h"

#include <string>

namespace excursion {

/// Fits of partial fractions with common poles to p responses to one input, weighted by the standard deviations. With
/// the poles given, C and D are linear least squares; both searches below use that and look for the poles alone.

struct PartialFractionFit {
    SecondOrderSections sections;
    Eigen::MatrixXd C;  ///< p x n
    Eigen::VectorXd D;
    double cost = 0.0;  ///< sum of |w (model - measured)|^2 over that of |w measured|^2
};

/// The best C and D for given poles. @throws Error (data) when there are several inputs, or the data is not valid
PartialFractionFit fitPartialFractions(const SecondOrderSections&, const FrequencyData&);

/// One relocation of relaxed vector fitting (Gustavsen & Semlyen 1999; Gustavsen 2006), for any number of outputs: G
/// sigma and sigma are fitted as partial fractions over the present poles, and the zeros of sigma, mirrored where
/// unstable, become the poles.
SecondOrderSections relocatePoles(const SecondOrderSections&, const FrequencyData&);

/// Lightly damped poles spread over the band of the data, to start relocations from.
SecondOrderSections spreadPoles(Eigen::Index order, const FrequencyData&, double sampleRate, double scale,
                                bool logarithmic, double alpha = 1.0);

struct PoleRefinementOptions {
    int maximumIterations = 50;
    /// stop when two accepted steps in a row lower the cost by less than this fraction
    double costTolerance = 1e-7;
    bool stable = true;  ///< steps that leave the stable region are refused

    bool isValid(std::string* reason = nullptr) const;
};

/// The search that these options ask for, over factors of poles.
SearchOptions searchFor(const PoleRefinementOptions&);

/// What a refinement found, and how it ended; costs are PartialFractionFit::cost.
struct PoleRefinement : SearchSummary {
    PartialFractionFit fit;
};

/// Maximum likelihood for Gaussian noise: search() on the weighted error over the factors of the poles, C
/// and D eliminated by variable projection (Golub & Pereyra 1973, in Kaufman's approximation 1975). Jacobians are
/// analytic; every least-squares problem is solved by orthogonal transformations.
/// @param start  stable, when that is asked for
PoleRefinement refinePoles(const SecondOrderSections& start, const FrequencyData&, const PoleRefinementOptions& = {},
                           const Progress& = {});

}  // namespace excursion
