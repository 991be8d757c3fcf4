// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Estimate/Record.h"
#include "Engine/Loudspeaker/Residual.h"
#include "Engine/Loudspeaker/SectionDrift.h"
#include "Engine/Progress.h"

#include <Eigen/Core>

#include <complex>
#include <optional>
#include <vector>

namespace excursion {

/// The residual of a model's simulation on one section.
struct SectionFit {
    bool finite = false;
    std::vector<NormalEquations> channels;                     ///< [channel]
    std::vector<ErrorPower> power;                             ///< [channel]
    SectionDrift::Amount drift;                                ///< of the section, where the record has one
    std::vector<std::vector<std::complex<double>>> predicted;  ///< [channel][line], if asked for
    std::vector<Eigen::MatrixXf> slopes;                       ///< [channel], J of N and g, if asked for
    Eigen::MatrixXd pulls;                                     ///< of all channels (Residual::pulls()), with N and g
    Eigen::MatrixXd shared;                                    ///< Residual::shared(), if asked for

    void pull(const Eigen::MatrixXd& ofChannel);  ///< adds to `pulls`
    /// Keeps what is known of some of the parameters that it was differentiated by.
    void keepSlopes(const std::vector<Eigen::Index>& places);
};

struct OutputErrorOptions {
    bool gradient = true;        ///< fill N and g
    bool spectra = false;        ///< fill predicted
    bool slopes = false;         ///< fill slopes
    bool shared = false;         ///< fill shared, with N and g
    bool sectionsDrift = false;  ///< as if the record said so (Record::sectionsDrift)
    int substeps = 1;  ///< of the simulation, per sample, at least 1; each in as many parts as its place asks for
    /// of the sensitivities: they may be coarser, as they only steer the search; raised to the smallest stable number
    int gradientSubsteps = 0;
    /// for quickError(): residuals of the simulation, slopes of fed laws
    bool played = false;
    unsigned threads = 2;
};

/// The number of samples until the model's periodic response is settled: until the slowest pole of the base has decayed
/// by 110 dB, and relaxations (creep) by 60 dB if they respond in the band, f > 0.3 of its low edge; loops in the iron,
/// which begin where nearly the right motion has brought them, by 60 dB. At most four periods. With hysteresis at least
/// two periods, in which the cone goes everywhere twice.
std::size_t settlingTime(const Model&, const Record&);

/// Simulates the model on the sections and compares (output error). Sections run in parallel; the result does not
/// depend on the number of threads.
/// @param sections  indices into record.sections
/// @param active    indices of the parameters to differentiate by, in the order of parametersOf(); N and g follow it
std::vector<SectionFit> outputError(const Model&, const Record&, const std::vector<std::size_t>& sections,
                                    const std::vector<Eigen::Index>& active, const OutputErrorOptions&,
                                    const Progress& = {});

/// All sections and channels together; none if one of them is not finite.
std::optional<NormalEquations> sumOf(const std::vector<SectionFit>&);

/// The pulls of bands (Residual::pulls()), those of one level together, and those of all sections without a level: what
/// a model lacks pulls them alike. One column a band of a level; empty where there are none.
/// @param sections  of the fits, indices into record.sections
Eigen::MatrixXd pullsOf(const std::vector<SectionFit>&, const Record&, const std::vector<std::size_t>& sections);

/// The sum of SectionFit::shared; empty where no section tells it.
Eigen::MatrixXd sharedOf(const std::vector<SectionFit>&);

/// The largest error power of a channel, over all sections, over that of its noise.
double worstPower(const std::vector<SectionFit>&);

/// Adds the priors: variance (parameter/prior)^2 for each active parameter that has a prior. The variance is that of
/// the residuals: while something large is missing in the model, the residual says as little about a shape as noise of
/// that size would.
/// @param slopes  of the active parameters by what the normal equations are by; none where that is the parameters
void addPrior(const Model&, const std::vector<Eigen::Index>& active, NormalEquations&, double variance = 1.0,
              const Eigen::VectorXd& slopes = {});

/// Indices of the free parameters of a model.
std::vector<Eigen::Index> freeParameters(const Model&);

}  // namespace excursion
