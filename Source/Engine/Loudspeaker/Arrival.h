// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace excursion {

/// Time derivative of a record of one period, by the DFT.
/// @param sampleRate  Hz
std::vector<double> slopeOf(std::span<const double> samples, double sampleRate);

/// Derivative of the arriving sound with respect to the instant s at which it left, x'(s)/(1 + lateness'(s)), at each
/// instant s. If the sound is late by another ds, its value at a fixed arrival time falls by this times ds.
std::vector<double> slopeByLeaving(std::span<const double> samples, std::span<const double> lateness,
                                   double sampleRate);

/// Sound with a delay (lateness) that varies: what leaves at s arrives at t = s + lateness(s). For a record of one
/// period, this finds for each arrival instant when the sound left, by Newton's iteration on the band-limited lateness.
/// It reads any record there,
///     y(t) = x(s(t)),   s(t) + lateness(s(t)) = t.
/// The lateness must change by less than one second per second, that is, the source must be slower than sound.
class Arrival {
public:
    /// @param lateness    s, one value per sample of the period; its mean may be of any size
    /// @param sampleRate  Hz
    Arrival(std::span<const double> lateness, double sampleRate);

    /// A record of the same period as it is heard: x(s(t)). Unchanged if the lateness is zero throughout.
    std::vector<double> heard(std::span<const double> samples) const;

    /// The same for a record of N samples with this spectrum, in a fraction of the time, within half a
    /// percent.
    std::vector<double> heardRoughly(std::vector<std::complex<double>> spectrum, std::size_t N) const;

    /// Eight neighbouring values of a finer record, and what they weigh at a place between them.
    static constexpr std::size_t points = 8;
    struct Taps {
        std::ptrdiff_t first;
        std::array<double, points> weight;
    };

private:
    std::vector<double> left_;  ///< samples; empty if there is no lateness
    std::vector<Taps> rough_;   ///< for heardRoughly(), which reads many records at the same places
};

}  // namespace excursion
