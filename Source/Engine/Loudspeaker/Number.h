// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <ceres/jet.h>

namespace excursion {

/// A number that carries its derivatives with respect to `jetWidth` parameters (forward-mode automatic
/// differentiation, ceres::Jet). The physics is written once, generic in the number type; run on double
/// it simulates, run on Jet it yields the sensitivities for the fit and the diagnosis.
inline constexpr int jetWidth = 8;
using Jet = ceres::Jet<double, jetWidth>;

/// A number that carries its derivatives with respect to time (slot 0) and to the coil's current (slot 1). Run on it,
/// the physics gives the derivatives of force and flux along a given motion, which an inversion needs.
using Tangent = ceres::Jet<double, 2>;

/// A value, limited to the bound above which it has no meaning.
template <class T>
T atMost(double limit, const T& value)
{
    return value < limit ? value : T(limit);
}

}  // namespace excursion
