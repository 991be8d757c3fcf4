// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include <complex>
#include <string>

namespace excursion {

/// The diffusive (ladder) realization of a fractional power on a band: first-order memories with rates spread over the
/// logarithm,
///     s^a ~ R + L s + sum_k R_k s/(s + p_k),     0 < a < 1,
/// and as s^(a-1) = s^a / s the integral with it,
///     s^(a-1) ~ L + R/s + sum_k R_k/(s + p_k).
/// Rates and R_k are those of LadderCells.h, whose relative error falls by a factor of 73 with each cell a decade. R, L
/// and one more cell on each side stand for the tails; cells beyond the band make up for the rest, some 10 000 times
/// less a decade. All numbers are positive: a passive network.
struct DiffusiveLadder {
    double exponent = 0.5;        ///< a
    double resistance = 0.0;      ///< R
    double inductance = 0.0;      ///< L
    Eigen::VectorXd rates;        ///< p_k in 1/s, ascending
    Eigen::VectorXd resistances;  ///< R_k

    Eigen::Index cells() const { return rates.size(); }

    /// The approximation of s^a; over s that of s^(a-1).
    std::complex<double> power(std::complex<double> s) const;
};

/// With n cells a decade the largest relative error on the band is below (tested for 0.05 <= a <= 0.95)
///     n      1       1.5     2       3       4       5
///     error  2.8e-2  3.3e-3  3.8e-4  5.3e-6  7.3e-8  1.0e-9
/// that of the rule itself times sin(pi a).
struct DiffusiveLadderOptions {
    double lowFrequency = 10.0, highFrequency = 20000.0;  ///< Hz
    double cellsPerDecade = 3.0;

    bool isValid(std::string* reason = nullptr) const;
};

/// Throws Error (usage) unless 0 < exponent < 1 and the options are valid.
DiffusiveLadder ladderFor(double exponent, const DiffusiveLadderOptions&);

}  // namespace excursion
