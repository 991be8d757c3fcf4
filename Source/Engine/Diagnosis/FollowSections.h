// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/Record.h"
#include "Engine/Loudspeaker/Model.h"
#include "Engine/Progress.h"

#include <optional>

namespace excursion {

/// Whether a record can tell moves between its sections, and does not have them followed yet (Record::sectionsDrift):
/// it has periods, several levels and a known noise.
bool tellsMoves(const Record&);

/// The model fitted again with small moves between the sections of a take followed (Record::sectionsDrift). None where
/// tellsMoves() denies them, where only noise is left without them, or where they explain neither all of it nor half.
std::optional<Model> followingSections(Model, const Record&, int substeps = 0, const Progress& = {});

}  // namespace excursion
