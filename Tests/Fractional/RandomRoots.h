// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Linear/Problem.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace excursion::test {

inline double drawn(Normal& normal, double low, double high)
{
    return low + (high - low) * 0.5 * std::erfc(-normal() / std::numbers::sqrt2);
}

inline std::complex<double> onRay(double f, double alpha)
{
    return std::pow(std::complex<double>(0.0, 2.0 * std::numbers::pi * f), alpha);
}

inline void addBoth(std::vector<std::complex<double>>& roots, std::complex<double> root)
{
    roots.push_back(root);
    if (root.imag() != 0.0)
        roots.push_back(std::conj(root));
}

}  // namespace excursion::test
