// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/LinearMotion.h"

#include <Eigen/Core>

#include <string>

namespace excursion {

/// The high-pass between a predistorter's output and the loudspeaker: the coupling capacitors of sound card and
/// amplifier,
///     order 1: H = s/(s + w),   order 2: H = s^2/(s^2 + sqrt(2) w s + w^2),   w = 2 pi corner.
struct AmplifierCoupling {
    double corner = 0.0;  ///< Hz, where 3 dB are lost; 0: a constant voltage passes
    int order = 1;        ///< 1 or 2

    static constexpr double lowest = 0.1, highest = 20.0;  ///< Hz
    bool passesConstant() const { return corner == 0.0; }
    double forgetting() const;  ///< s, in which it forgets: five time constants; 0 where it withholds nothing
    bool operator==(const AmplifierCoupling&) const = default;
    bool isValid(std::string* reason) const;
};

/// What it withholds of a voltage u: l = (1 - H) u = C m, with dm/dt = A m + B u. None of it is immediate, so l is
/// known before u is.
struct Withheld {
    explicit Withheld(const AmplifierCoupling&);

    Eigen::MatrixXd A, B, C;  ///< n x n, n x 1, 1 x n; n is the order, or 0 if a constant voltage passes; 1/s, 1/s, 1
};

/// The motion of a loudspeaker behind it: its state, then m.
LinearMotion behind(const LinearMotion&, const AmplifierCoupling&);

}  // namespace excursion
