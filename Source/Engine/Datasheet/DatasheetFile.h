// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Datasheet/LawTable.h"
#include "Engine/Datasheet/LossyInductance.h"
#include "Engine/Datasheet/ThieleSmall.h"
#include "Engine/Design/StrokeLimits.h"

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// What a designer takes out of a model for other programs.
struct Datasheet {
    std::string driver;  ///< its name; may be empty
    std::vector<DatasheetFigure> thieleSmall;
    std::optional<LossyInductance> inductance;  ///< none without a coil
    std::vector<LawTable> laws;
    std::optional<StrokeLimits> stroke;  ///< none where the motion is a guess
    std::vector<std::string> remarks;    ///< whole sentences: what the numbers rest on
};

/// @param bandLow, bandHigh  of lossyInductance()
/// @param lawPoints          of lawTables()
Datasheet datasheetOf(const ScaledModel&, double bandLow = 0.0, double bandHigh = 0.0, int lawPoints = 41);

/// Document "excursion-parameters", version 1 (Docs/Formats.md), without the names of files.
nlohmann::ordered_json toJson(const Datasheet&);

/// symbol,value,standard_error,unit,remark: the parameters in the units of datasheets, then the forms of the lossy
/// inductance.
std::string parametersCsv(const Datasheet&);

/// law,argument,argument_unit,at,value,low_95,high_95,unit: one row a point, then the limits of the stroke as rows
/// "limit".
std::string lawsCsv(const Datasheet&);

}  // namespace excursion
