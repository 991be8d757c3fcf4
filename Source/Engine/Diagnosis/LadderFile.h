// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/PreparedTake.h"
#include "Engine/Design/WhatIf.h"
#include "Engine/Diagnosis/Ladder.h"
#include "Engine/Loudspeaker/FitResponse.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// A description of the take, in words and numbers, for the report.
struct TakeSummary {
    std::string path;         ///< as given
    std::string driver;       ///< its name; empty if unknown
    double sampleRate = 0.0;  ///< Hz; 0 for a frequency response
    double seconds = 0.0;
    std::vector<std::string> channels;  ///< "voltage", ...
    std::vector<double> levels;         ///< V rms
    int realizations = 0, periods = 0;  ///< 0 if the take has no such structure
};
TakeSummary summarize(const PreparedTake&, const std::string& path);

/// A ladder with everything that a report needs, so that `report` can run again without the take. Format
/// "excursion-ladder", version 1 (Docs/Formats.md).
struct LadderFile {
    Ladder ladder;
    TakeSummary take;
    /// measured at the quietest level; for an electrical driver they include the impedance
    std::vector<ResponseTarget> responses;
    /// for the last model, if it has an effect that distorts and the take is in the time domain
    std::optional<WhatIf> whatIf;
};

/// The distortion by the model's effects in a take, at its loudest level. Nothing if no effect distorts, the take is a
/// frequency response, or the model cannot be simulated.
std::optional<WhatIf> whatIfOf(const Model&, const PreparedTake&, const Progress& = {});

/// @throws Error (data) if the take has no channel to compare
LadderFile makeLadderFile(Ladder, const PreparedTake&, const std::string& path);

nlohmann::ordered_json toJson(const LadderFile&);
LadderFile ladderFromJson(const nlohmann::json&, const std::string& where);

LadderFile readLadder(const std::filesystem::path&);
void writeLadder(const LadderFile&, const std::filesystem::path&);

}  // namespace excursion
