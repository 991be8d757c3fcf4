// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Cli/Terminal.h"

#include "Engine/Predistortion/RealTime.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <optional>

namespace excursion::cli {

/// The options that say what a linearized driver is to move like.
struct TargetArguments {
    std::optional<double> frequency, quality, litres;
    bool asked() const { return frequency || quality || litres; }
};

void addTargetOptions(CLI::App& verb, TargetArguments&);

/// What is not given of f0 and Q is the driver's own. Throws Error, see OwnResonance::require; (usage) for a box beside
/// f0 or Q.
Target targetFrom(const TargetArguments&, const Model&);

/// Tells what the controls' target costs at full scale, and returns it for the document.
nlohmann::ordered_json tellTarget(const Model&, const PredistortionControls&, double fullScale, Terminal&);

}  // namespace excursion::cli
