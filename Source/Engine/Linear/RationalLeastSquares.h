// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/PartialFractionFit.h"

namespace excursion {

/// Fits of a quotient of polynomials N/D by linear least squares: the classical ways, here for comparison ([B 4.4.2]
/// has Levy's as "complex LS", MATLAB's invfreqz), not as estimators.
///     Levy (1959)                   minimize sum |w (N - G D)|^2: the error counts |D|^2 as much as it should, most
///         where D is large
///     Sanathanan & Koerner (1963)   again, divided by the |D| found before, until D stays; with noise its limit is
///         close to, and not, the least error
/// D has a leading coefficient of 1 (a constant one of 1 gives another answer where nothing fits exactly). N and D are
/// written in polynomials that are orthonormal on the lines (OrthogonalPowers.h), not in powers of the frequency, which
/// are what both methods are known to fail of; the roots of D are eigenvalues of the recurrence. Several outputs share
/// D. Nothing keeps the poles stable.
struct RationalOptions {
    int order = 4;             ///< of D, and of N
    double sampleRate = 0.0;   ///< Hz; 0: continuous time
    int iterations = 0;        ///< of Sanathanan and Koerner; 0: Levy
    double tolerance = 1e-10;  ///< stop when D changes by less than this, relative

    bool isValid(std::string* reason = nullptr) const;
};

/// Levy's is solved at once, Sanathanan and Koerner's settles where D stays; costs are those of N/D - G.
struct RationalFit : SearchSummary {
    PartialFractionFit fit;  ///< N/D itself
};

/// Throws Error (usage) for options that make no sense, (data) for data that cannot be fitted, has several inputs or
/// too few lines, (numerical) when D has no roots in finite numbers.
RationalFit fitRational(const FrequencyData&, const RationalOptions&);

}  // namespace excursion
