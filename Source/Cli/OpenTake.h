// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/PreparedTake.h"
#include "Engine/Loudspeaker/Model.h"
#include "Engine/Estimate/Record.h"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

namespace excursion::cli {

class Terminal;

/// A take that a model is fitted to or judged by.
struct OpenTake {
    std::string path;
    PreparedTake take;
};

OpenTake openTake(const std::string& path);

/// Throws Error (usage) when an effect cannot be part of a model of this take: it needs a coil that is not there, or is
/// nonlinear and the take is a frequency response.
void requireEffects(const std::vector<std::string>& ids, const PreparedTake&);

/// The record of a take that is not a frequency response, adapted to the model.
Record recordFor(const Model&, const OpenTake&);

/// One line a problem: "fault   clipping: ..." or "remark  hum: ...".
void sayProblems(const std::vector<Problem>&, Terminal&);

/// Ends a verb that would have fitted a model to a take that is at fault: says why, writes the document, and makes the
/// answer no.
void refuseTake(const OpenTake&, nlohmann::ordered_json document, Terminal&);

}  // namespace excursion::cli
