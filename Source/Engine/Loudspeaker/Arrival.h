// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace excursion {

/// Derivative by time of a record of one period, by the DFT.
/// @param sampleRate  Hz
std::vector<double> slopeOf(std::span<const double> samples, double sampleRate);

/// Derivative of what arrives by the instant at which it has left, x'(s)/(1 + lateness'(s)), at each instant s: sound
/// that leaves by ds later arrives as it is told by this times ds less.
std::vector<double> slopeByLeaving(std::span<const double> samples, std::span<const double> lateness,
                                   double sampleRate);

/// Sound that is late by an amount that changes: what leaves at s arrives at t = s + lateness(s). For a record of one
/// period this tells when what arrives at each of its instants has left, by Newton's iteration on the band-limited
/// lateness, and reads any record there,
///     y(t) = x(s(t)),   s(t) + lateness(s(t)) = t.
/// The lateness must change by less than one second a second, which is to say that the source is slower than sound.
class Arrival {
public:
    /// @param lateness    s, one value a sample of the period; its mean is no matter of size
    /// @param sampleRate  Hz
    Arrival(std::span<const double> lateness, double sampleRate);

    /// A record of the same period, heard: x(s(t)). As it is when the lateness is zero throughout.
    std::vector<double> heard(std::span<const double> samples) const;

    /// The same of a record of N samples that has this spectrum, at a third of the price: within half a percent.
    std::vector<double> heardRoughly(std::vector<std::complex<double>> spectrum, std::size_t N) const;

private:
    std::vector<double> read(std::vector<std::complex<double>> spectrum, std::size_t N, int finer) const;

    std::vector<double> left_;  ///< samples; empty when nothing is late
};

}  // namespace excursion
