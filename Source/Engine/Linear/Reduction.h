// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/PartialFractionFit.h"
#include "Engine/Linear/StateSpace.h"

#include <vector>

namespace excursion {

/// Smaller models in place of large ones [B 6.1].

/// A model whose states are as well reached as they are seen: both Gramians are diag(sigma) [B 6.11 to 6.21], sigma
/// descending.
struct Balanced {
    StateSpace model;
    Eigen::VectorXd singularValues;  ///< Hankel singular values
};

/// Balances a stable model. The Gramians are summed by Smith's doubling; those of a continuous-time model are those of
/// its bilinear transform (the factors sqrt(2a) of Bilinear.h make them equal), at a rate that puts its poles in the
/// middle of the circle. States that no input reaches or no output sees (sigma below 1e-14 of the largest) are dropped.
/// Throws Error (usage) when the model is not valid, (data) when it is not stable.
Balanced balanced(const StateSpace&);

enum class Truncation {
    /// the states with small sigma are left out (method 1 of [B 6.1.4]): exact at infinite frequency, or z = infinity
    direct,
    singularPerturbation  ///< they are taken as settled at once (method 2): exact at frequency 0
};

/// The first `order` states of a balanced model; fewer where it has no more. |G - G_reduced| <= 2 (sigma_{order+1} + ..
/// + sigma_n) at every frequency. Singular perturbation in discrete time settles x2 = A21 x1 + A22 x2 + B2 u; [B 6.23]
/// prints A22^-1 where (I - A22)^-1 is meant, and leaves out what D gains, C2 (I - A22)^-1 B2.
StateSpace truncated(const Balanced&, Eigen::Index order, Truncation);

/// 2 (sigma_{order+1} + .. + sigma_n).
double truncationBound(const Balanced&, Eigen::Index order);

/// One stage of a pruning: after a section was taken out and the rest refitted.
struct PruningStep {
    Eigen::Index order = 0;
    double cost = 0.0;     ///< PartialFractionFit::cost
    double errorDb = 0.0;  ///< 10 log10(cost): weighted relative error
};

struct PruningOptions {
    int order = 0;                 ///< go no lower than this
    double errorDb = 0.0;          ///< and stop before the weighted relative error would pass this; 0 dB: no bound
    int refinementIterations = 8;  ///< after every section
    bool isValid(std::string* reason = nullptr) const;
};

struct Pruning {
    PartialFractionFit fit;          ///< the smallest that keeps the bound
    std::vector<PruningStep> steps;  ///< from the start down, the last one being `fit`
    std::string reason;              ///< why it stopped
};

/// Automatic pruning: takes out the section whose loss costs least, refits all others to the data by maximum
/// likelihood, and goes on. Each step reports the error that was measured, so none rests on a bound of the ripple
/// alone.
/// @param start  stable
Pruning prune(const PartialFractionFit& start, const FrequencyData&, const PruningOptions&, const Progress& = {});

}  // namespace excursion
