// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/LawMemory.h"
#include "Engine/Loudspeaker/Record.h"

#include <complex>
#include <vector>

namespace excursion {

using Spectrum = std::vector<std::complex<double>>;  ///< unnormalized DFT of a real period, lines 0 .. N/2

/// The motion of coil and cone over one period, band-limited.
struct ShownMotion {
    static constexpr std::size_t fine = 2;  ///< values a sample of the record
    std::vector<double> i, slope, x, v, a;  ///< A, A/s, m, m/s, m/s^2; `fine` values a sample
};

/// One value a sample of the motion.
PeriodicMotion everySample(const ShownMotion&);

/// What a periodic section tells of the motion. A line of the current, or of the displacement (from every channel of
/// motion, weighted by its noise), that stands three times above its noise is taken as it was measured, any other as it
/// is expected.
/// @param current, displacement  expected spectra of the section's window, A and m
ShownMotion shownMotion(const Record&, const Section&, const Spectrum& current, const Spectrum& displacement);

}  // namespace excursion
