// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/FrequencyData.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalPnlss.h"
#include "Engine/Ranking/Rank.h"

#include <nlohmann/json.hpp>

#include <functional>

namespace excursion {

/// What every class is fitted to.
struct RankedTake {
    const PreparedTake& take;
    const Channel& input;
    const Channel& output;
    int level;
    PnlssRecords records;
    FrequencyData response;  ///< output over input
    RankOptions options;
    int order;          ///< of the polynomial models
    StateSpace linear;  ///< of the best order, in discrete time
};

/// A fitted class: how it plays a record from rest (N x 1), and what it says of itself.
struct FittedClass {
    std::function<Eigen::MatrixXd(const PnlssRecord&)> play;
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
