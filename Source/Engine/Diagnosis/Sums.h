// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/OutputError.h"
#include "Engine/Loudspeaker/Record.h"

#include <map>
#include <vector>

namespace excursion {

/// Mean squared residuals in units of the noise: where a model is near enough for details to count, and where nothing
/// is needed beyond.
inline constexpr double nearNoise = 4.0, atNoise = 1.3;

struct ScoreOptions {
    int substeps = 1;
    bool played = false;  ///< residuals of a simulation in place of those of fed laws
    unsigned threads = 2;
    int degree = 6;  ///< of the laws that are tried
    /// a model that tells the shapes of linear effects; those that it does not have are not tried. None: they are
    /// searched for
    const Model* shapes = nullptr;
};

/// What a model leaves and how that moves with its parameters: normal equations on sections to estimate on and on those
/// that were held out, by channel, by level and summed.
struct Sums {
    NormalEquations estimation, validation;
    std::vector<NormalEquations> byChannel;  ///< of the validation sections
    std::map<int, NormalEquations> byLevel;  ///< of the estimation sections
    std::vector<ErrorPower> power;           ///< of the validation sections
    bool finite = true;
};

/// Sections for a quick look or fit: of each level up to `realizations` of those not held out.
std::vector<std::size_t> trialSections(const Record&, int realizations);

/// By the quick error of FeedbackError.h.
/// @param sections  to estimate on; those held out come by themselves
Sums sumsOf(const Model&, const Record&, std::vector<std::size_t> sections, const std::vector<Eigen::Index>& active,
            const ScoreOptions&, const Progress& = {});

/// What a step d of the parameters leaves, never below zero.
double predictedCost(const NormalEquations&, const Eigen::VectorXd& d);

/// Places of the free strengths of component k among the active parameters.
std::vector<Eigen::Index> strengthPlaces(const Model&, std::size_t k, const std::vector<Eigen::Index>& active);

}  // namespace excursion
