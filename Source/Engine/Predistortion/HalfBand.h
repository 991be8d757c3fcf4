// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace excursion {

/// A linear-phase half-band filter between two rates, one twice the other, as a sinc under a Kaiser window (Kaiser &
/// Schafer, IEEE Trans. ASSP 28, 1980):
///     h_0 = 1/2,   h_k = sin(pi k/2)/(pi k) w(k) = h_-k for odd k <= reach,   h_k = 0 for the other even k.
/// With frequencies relative to the higher rate, the pass band ends at 1/4 - width/2 and the stop band begins at 1/4 +
/// width/2, both with an error of 10^(-attenuation/20).
struct HalfBandTaps {
    /// @param width        width of the transition, relative to the higher rate
    /// @param attenuation  dB, more than 50
    HalfBandTaps(double width, double attenuation);

    /// odd; the delay of one pass, samples of the higher rate
    int reach() const { return 2 * static_cast<int>(side.size()) - 1; }
    std::vector<double> side;  ///< h_1, h_3, h_5, ...
};

/// Doubles the rate of one channel, with a delay of reach() samples of the higher rate.
class Doubler {
public:
    Doubler(const HalfBandTaps&, std::size_t longestBlock);
    void reset();

    /// @param in   n <= longestBlock samples
    /// @param out  2 n samples; must not overlap `in`
    void process(const double* in, std::size_t n, double* out);

private:
    std::vector<double> taps_;     ///< the odd taps, from the newest to the oldest, times 2
    std::vector<double> history_;  ///< the latest taps_.size() - 1 inputs, then room for a block
};

/// Halves the rate of one channel, with a delay of reach() samples of the higher rate.
class Halver {
public:
    Halver(const HalfBandTaps&, std::size_t longestBlock);
    void reset();

    /// @param in   2 n samples
    /// @param out  n <= longestBlock samples; may be `in`
    void process(const double* in, std::size_t n, double* out);

private:
    std::vector<double> taps_;
    std::vector<double> even_, odd_;  ///< histories of the two phases, then room for a block
};

}  // namespace excursion
