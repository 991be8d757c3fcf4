// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/OutputError.h"
#include "Engine/Estimate/Record.h"

#include <map>
#include <vector>

namespace excursion {

/// Mean squared residuals in units of the noise: below nearNoise details count, at atNoise nothing more is needed.
inline constexpr double nearNoise = 4.0, atNoise = 1.3;

struct ScoreOptions {
    int substeps = 1;
    bool played = false;  ///< residuals from a simulation instead of fed laws
    unsigned threads = 2;
    int degree = 6;  ///< degree of the laws that are tried
    /// a model that gives the shapes of linear effects; effects that it lacks are not tried. None: the shapes are
    /// searched for
    const Model* shapes = nullptr;

    OutputErrorOptions run() const;  ///< for quickError()
};

/// The residual of a model and its sensitivities to the parameters: normal equations on the estimation sections and on
/// the held-out sections, by channel, by level and summed.
struct Sums {
    NormalEquations estimation, validation;
    std::vector<NormalEquations> byChannel;  ///< of the validation sections
    std::map<int, NormalEquations> byLevel;  ///< of the estimation sections
    std::vector<ErrorPower> power;           ///< of the validation sections
    bool finite = true;
};

/// Sections for a quick test or fit: from each level, up to `realizations` of those not held out.
std::vector<std::size_t> trialSections(const Record&, int realizations);

/// With the quick error of FeedbackError.h.
/// @param sections  for estimation; the held-out ones are added automatically
Sums sumsOf(const Model&, const Record&, std::vector<std::size_t> sections, const std::vector<Eigen::Index>& active,
            const ScoreOptions&, const Progress& = {});

/// The cost predicted after a step d of the parameters, never below zero.
double predictedCost(const NormalEquations&, const Eigen::VectorXd& d);

/// Places of the free strengths of component k among the active parameters.
std::vector<Eigen::Index> strengthPlaces(const Model&, std::size_t k, const std::vector<Eigen::Index>& active);

}  // namespace excursion
