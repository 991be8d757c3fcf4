// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/PreparedTake.h"
#include "Engine/Linear/FrequencyData.h"
#include "Engine/Linear/StateSpace.h"
#include "Engine/Polynomial/TakeRecords.h"
#include "Engine/Progress.h"

#include <nlohmann/json.hpp>

#include <functional>
#include <string>

namespace excursion {

/// What every class is fitted to.
struct RankedTake {
    const PreparedTake& take;
    const Channel& input;
    const Channel& output;
    int level;
    InputOutputRecords records;
    FrequencyData response;  ///< output over input
    int order;               ///< of the polynomial models
    bool orderGiven;         ///< else other orders may be tried as well
    int degree;              ///< of monomials and powers
    int iterations;          ///< of each search in the time domain, at most
    StateSpace linear;       ///< of the best order, in discrete time
};

/// A fitted class: how it plays a record from rest (N x 1), and what it says of itself.
struct FittedClass {
    std::function<Eigen::MatrixXd(const InputOutputRecord&)> play;
    std::string description;
    int parameters = 0;
    bool stable = false;
    nlohmann::ordered_json document = nullptr;  ///< of the model, for the classes that have one
};

FittedClass fitLinearClass(const RankedTake&, const Progress&);
FittedClass fitFractionalClass(const RankedTake&, const Progress&);
FittedClass fitHammersteinClass(const RankedTake&, const Progress&);
FittedClass fitBlockClass(const RankedTake&, const Progress&);
FittedClass fitNarxClass(const RankedTake&, const Progress&);
FittedClass fitPnlssClass(const RankedTake&, const Progress&);
FittedClass fitFractionalPnlssClass(const RankedTake&, const Progress&);
FittedClass fitDriverClass(const RankedTake&, const Progress&);
FittedClass fitDriverWithEffectsClass(const RankedTake&, const Progress&);

}  // namespace excursion
