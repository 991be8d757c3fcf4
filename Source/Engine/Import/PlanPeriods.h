// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/Measurement.h"
#include "Engine/Take/SweepExcitation.h"

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace excursion {

/// The periods of a plan in the order of time, settling ones among them, with what each of them plays. Of a plan of
/// sweeps each sweep is one, with the silence behind it: as the loudspeaker is at rest before it, its spectra divide as
/// those of periods do.
struct PlanPeriods {
    struct Period {
        std::size_t start = 0;  ///< sample of the plan
        std::size_t block = 0;  ///< level * realizations + realization
        bool used = false;      ///< false: it settles
    };

    std::size_t length = 0;  ///< samples of one period, N
    std::vector<int> lines;  ///< excited, ascending
    std::vector<Period> periods;
    /// of each block, one value a line: the DFT of its last period
    std::vector<std::vector<std::complex<double>>> played;
    bool sweeps = false;  ///< the frequency runs through the band within each of them

    /// The DFT over one period of samples, at the excited lines.
    std::vector<std::complex<double>> at(std::span<const double> onePeriod) const;
};

/// @param plan  with an excitation and its input. Throws Error (data) when the plan has no periods or is shorter than
/// it says.
PlanPeriods periodsOf(const Measurement& plan);

/// Sweeps written as periods: one used period a realization, no settling ones, the lines those of the band.
Excitation periodsOfSweeps(const SweepExcitation&, double sampleRate);

}  // namespace excursion
