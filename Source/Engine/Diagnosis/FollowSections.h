// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/Record.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Progress.h"

#include <optional>

namespace excursion {

/// Whether a record can tell moves between its sections, and does not have them followed yet (Record::sectionsDrift):
/// it has periods, several levels and a known noise.
bool tellsMoves(const Record&);

/// Whether a model that leaves more than noise leaves noise, or much less, where small moves between the sections of a
/// take are followed. Not where tellsMoves() denies them.
bool movesExplain(const Model&, const Record&, int substeps = 0, const Progress& = {});

struct Following {
    Model model;
    FitSummary fit;
};

/// A model that was fitted without small moves between the sections of a take, fitted again with these followed
/// (Record::sectionsDrift). None where they do not explain what it leaves, as in movesExplain(), then.
std::optional<Following> followingSections(Model, const Record&, int substeps = 0, const Progress& = {});

}  // namespace excursion
