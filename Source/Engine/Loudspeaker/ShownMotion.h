// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/LawMemory.h"
#include "Engine/Loudspeaker/Model.h"
#include "Engine/Estimate/Record.h"

#include <complex>
#include <vector>

namespace excursion {

using Spectrum = std::vector<std::complex<double>>;  ///< unnormalized DFT of a real period, lines 0 .. N/2

/// The motion of coil and cone over one period, band-limited.
struct ShownMotion {
    static constexpr std::size_t fine = 2;  ///< values per sample of the record
    std::vector<double> i, slope, x, v, a;  ///< A, A/s, m, m/s, m/s^2; `fine` values per sample
};

/// The motion with one value per sample.
PeriodicMotion everySample(const ShownMotion&);

/// The motion that a periodic section shows. A line of the current, or of the displacement (from every motion channel,
/// weighted by its noise), that is three times above its noise is used as measured. Any other line is used as expected.
/// @param model  tells the responses of its sensors (SensorResponse.h), which are undone
/// @param current, displacement  expected spectra of the section's window, A and m
ShownMotion shownMotion(const Model& model, const Record&, const Section&, const Spectrum& current,
                        const Spectrum& displacement);

}  // namespace excursion
