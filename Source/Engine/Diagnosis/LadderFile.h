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

/// What the take was, in words and numbers that a report shows.
struct TakeSummary {
    std::string path;         ///< as it was given
    std::string driver;       ///< its name; empty when not told
    double sampleRate = 0.0;  ///< Hz; 0 for a frequency response
    double seconds = 0.0;
    std::vector<std::string> channels;  ///< "voltage", ...
    std::vector<double> levels;         ///< V rms
    int realizations = 0, periods = 0;  ///< 0 when the take has no such structure
};
TakeSummary summarize(const PreparedTake&, const std::string& path);

/// A ladder with all that a report needs, so that `report` can be run again without the take. Format
/// "excursion-ladder", version 1 (Docs/Formats.md).
struct LadderFile {
    Ladder ladder;
    TakeSummary take;
    /// measured at the quietest level; of an electrical driver the impedance is among them
    std::vector<ResponseTarget> responses;
    /// of the last model, where it has an effect that distorts and the take is one in time
    std::optional<WhatIf> whatIf;
};

/// What the model's effects make of a take: of its loudest level. Nothing where no effect distorts, the take is a
/// frequency response, or the model cannot be played.
std::optional<WhatIf> whatIfOf(const Model&, const PreparedTake&, const Progress& = {});

/// @throws Error (data) when the take has no channel to compare
LadderFile makeLadderFile(Ladder, const PreparedTake&, const std::string& path);

nlohmann::ordered_json toJson(const LadderFile&);
LadderFile ladderFromJson(const nlohmann::json&, const std::string& where);

LadderFile readLadder(const std::filesystem::path&);
void writeLadder(const LadderFile&, const std::filesystem::path&);

}  // namespace excursion
