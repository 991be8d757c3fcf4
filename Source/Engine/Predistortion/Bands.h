// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>

namespace excursion {

/// Splits a signal into three bands that sum to it, lowest first. H_1 and H_2 are second-order high-passes in series.
/// The bands are
///     u - H_1 u,   H_1 u - H_2 H_1 u,   H_2 H_1 u.
/// Turning a band down leaves a second-order high-pass, so what moves the cone most goes first. There is no delay.
class Bands {
public:
    static constexpr std::size_t count = 3;
    using Values = std::array<double, count>;

    /// @param first, second  Hz, corner frequencies; limited to 0.2 and 0.4 of the sample rate
    Bands(double first, double second, double sampleRate);

    void reset();
    Values split(double u);

private:
    /// Second-order Butterworth high-pass in the trapezoidal form (Zavalishin, The Art of VA Filter Design, 2012,
    /// section 4).
    struct HighPass {
        double a1 = 0.0, a2 = 0.0, a3 = 0.0, first = 0.0, second = 0.0;
        double step(double u);
    };
    std::array<HighPass, 2> filters_;
};

}  // namespace excursion
