// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <vector>

namespace excursion {

/// A frequency response function G = output/input on a grid of frequencies, with its sample variances
/// [B 4.2.2, appendix A]. Variances are of the complex estimate: E|G - E G|^2. All vectors that
/// are not empty have the same length.
struct Frf {
    std::vector<double> frequency;            ///< Hz, ascending, never 0
    std::vector<std::complex<double>> value;  ///< output unit / input unit
    std::vector<double> noiseVariance;        ///< of `value`, from the scatter over periods; empty if unknown
    std::vector<double> totalVariance;        ///< of `value`, from the scatter over realizations; empty if unknown
};

}  // namespace excursion
