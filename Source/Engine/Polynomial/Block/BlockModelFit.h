// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/Block/BlockModel.h"
#include "Engine/Polynomial/Pnlss/PnlssFit.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace excursion {

struct BlockModelFitOptions {
    int degree = 3;  ///< of the polynomials, 2 .. 20
    int maximumBranches = 3;
    double worthwhileDb = 0.5;  ///< a branch has to lower the error by this much
    /// of the last refinement; 0: none at all, G stays what it was but for its gain, as in [B 4.1.1]
    int maximumIterations = 50;

    bool isValid(std::string* reason = nullptr) const;
};

/// One branch that was chosen, or the linear part alone at the beginning.
struct BlockStep {
    std::optional<BlockBranch> branch;  ///< none: the linear part
    /// relative rms error [B 4.26] of a simulation with it, on the records that judge
    double errorDb = 0.0;
    std::map<BlockBranch, double> errorDbOf;  ///< that of each branch that competed for this step
};

/// What became of a fit, and how its last refinement ended; costs are relative squared errors.
struct BlockModelFit : SearchSummary {
    BlockModel model;
    std::vector<BlockStep> steps;  ///< in the order in which branches were chosen
    /// of each branch in the model: its output's power over that of the judging records
    std::map<BlockBranch, double> powerDb;
    /// relative rms error [B 4.26]; validation NaN without records
    double estimationDb = 0.0, validationDb = 0.0;
    bool stable = false;  ///< G is
};

/// The procedure of [B 4.1.1]: G is the best linear approximation (a model of it, as identify() gives), branches are
/// chosen by what they explain, and their polynomials found. With G given the output is linear in all that is unknown,
/// so a trial begins with least squares on the triangular factor of all branches' outputs. [B] leaves G as it is
/// and chooses by the power of the branches. But the best linear approximation holds part of the distortion, most of
/// all where there is feedback, and branches can explain each other's output; so each trial is refined for a few steps,
/// G with it, that branch is taken that leaves the least simulation error on the validation records (without any: on
/// the estimation records), then the next beside it, and all is refined at last by search() on the simulation error, G
/// kept stable. The powers are told.
/// Throws Error (usage) for options that make no sense or a linear part that is not stable, of discrete time, with one
/// input and one output; (data) for records that do not fit.
BlockModelFit fitBlockModel(const StateSpace& linear, const std::vector<InputOutputRecord>& estimation,
                            const std::vector<InputOutputRecord>& validation, const BlockModelFitOptions& = {},
                            const Progress& = {});

}  // namespace excursion
