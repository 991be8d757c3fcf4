// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Loudspeaker/Record.h"
#include "Engine/Loudspeaker/Residual.h"
#include "Engine/Progress.h"

#include <Eigen/Core>

#include <complex>
#include <optional>
#include <vector>

namespace excursion {

/// What a model's simulation leaves of one section.
struct SectionFit {
    bool finite = false;
    std::vector<NormalEquations> channels;                     ///< [channel]
    std::vector<ErrorPower> power;                             ///< [channel]
    std::vector<std::vector<std::complex<double>>> predicted;  ///< [channel][line], when asked for
};

struct OutputErrorOptions {
    bool gradient = true;  ///< fill N and g
    bool spectra = false;  ///< fill predicted
    int substeps = 1;      ///< of the simulation, at least; raised to the fewest with which it is stable
    /// of the sensitivities: they may be coarser, as they only steer the search; 0: the fewest
    int gradientSubsteps = 0;
    /// of quickError(): residuals of the simulation, slopes of laws that are fed
    bool played = false;
    unsigned threads = 2;
};

/// How many samples the model must run before its periodic response is settled: until the slowest pole of the base has
/// decayed by 110 dB, and relaxations (creep) by 60 dB as far as they answer to the band, f > 0.3 of its low edge; at
/// most four periods. With hysteresis at least two, in which the cone goes everywhere twice.
std::size_t settlingTime(const Model&, const Record&);

/// Simulates the model on the sections and compares (output error). Sections run in parallel; the result does not
/// depend on the number of threads.
/// @param sections  indices into record.sections
/// @param active    indices of the parameters to differentiate by, in the order of parametersOf(); N and g follow it
std::vector<SectionFit> outputError(const Model&, const Record&, const std::vector<std::size_t>& sections,
                                    const std::vector<Eigen::Index>& active, const OutputErrorOptions&,
                                    const Progress& = {});

/// All sections and channels together; none where one of them is not finite.
std::optional<NormalEquations> sumOf(const std::vector<SectionFit>&);

/// The largest error power of a channel, over all sections, over that of its noise.
double worstPower(const std::vector<SectionFit>&);

/// Adds what is plausible beforehand: variance (parameter/prior)^2 for each active parameter that has a prior. The
/// variance is that of the residuals: while something large is missing in the model, what is left says as little about
/// a shape as noise of that size would.
void addPrior(const Model&, const std::vector<Eigen::Index>& active, NormalEquations&, double variance = 1.0);

/// Indices of the free parameters of a model.
std::vector<Eigen::Index> freeParameters(const Model&);

/// Indices of the sections to estimate on, and of those held out (all sections when none is held out).
std::vector<std::size_t> estimationSections(const Record&);
std::vector<std::size_t> validationSections(const Record&);

}  // namespace excursion
