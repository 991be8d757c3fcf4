// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Cli/Terminal.h"

#include "Engine/Predistortion/TargetForecast.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

namespace excursion::cli {

/// The options that say what a linearized driver is to move like.
struct TargetArguments {
    std::optional<double> frequency, quality, litres;
    std::vector<double> flat;     ///< Hz, lower and upper end
    std::string gains, response;  ///< files
    bool equalizes() const { return !flat.empty() || !gains.empty() || !response.empty(); }
    bool asked() const { return frequency || quality || litres || equalizes(); }
};

void addTargetOptions(CLI::App& verb, TargetArguments&);

/// What is not given of f0 and Q is the loudspeaker's own. Throws Error, see OwnLinearPart::require; (usage) for one
/// kind of target beside another; (input), see readLevelCurve.
Target targetFrom(const TargetArguments&, const OwnLinearPart&);

/// Tells what a target costs at full scale, and returns it for the document.
/// @param unit  of the input, "V"
nlohmann::ordered_json tellTarget(const TargetForecast&, Target::Kind, double fullScale, const std::string& unit,
                                  Terminal&);

}  // namespace excursion::cli
