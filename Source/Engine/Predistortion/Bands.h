// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>

namespace excursion {

/// Splits a signal in three that sum up to it, lowest first: H_1 and H_2 are high-passes of second order in a row, the
/// bands are
///     u - H_1 u,   H_1 u - H_2 H_1 u,   H_2 H_1 u.
/// A band that is turned down leaves a high-pass of second order, so what moves a cone goes first, and there is no
/// delay.
class Bands {
public:
    static constexpr std::size_t count = 3;
    using Values = std::array<double, count>;

    /// @param first, second  Hz, corners; kept below 0.2 and 0.4 of the sample rate
    Bands(double first, double second, double sampleRate);

    void reset();
    Values split(double u);

private:
    /// Butterworth's high-pass of second order in the trapezoidal form (Zavalishin, The Art of VA Filter Design, 2012,
    /// section 4).
    struct HighPass {
        double a1 = 0.0, a2 = 0.0, a3 = 0.0, first = 0.0, second = 0.0;
        double step(double u);
    };
    std::array<HighPass, 2> filters_;
};

}  // namespace excursion
