// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Identifying.h"

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

namespace excursion::plugin {

struct PnlssWish {
    int degree = 3;
    int iterations = 50;
};

/// A polynomial model that was fitted to the periods of a take. It does not change once it is handed out.
struct FittedPnlss {
    nlohmann::ordered_json document;  ///< as `pnlss --out` writes it, with what it was fitted under
    double startDb = 0.0, estimationDb = 0.0;
    std::optional<double> validationDb, noiseDb;
    std::vector<double> history;  ///< dB after each step
    int terms = 0;
    bool stable = false;
    std::string words;  ///< what came of it, in a sentence
};

/// Begins at the linear model that is shown. Throws Error (data) for a take without time, a model with a delay or, of
/// fractional order, one that is not below 1, and as fitPnlss() does.
FittedPnlss pnlssOf(const PreparedTake&, const Identified&, const PnlssWish&, const Progress& = {});

std::string shortWordsOf(const FittedPnlss&);

}  // namespace excursion::plugin
