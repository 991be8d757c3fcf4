// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/Record.h"
#include "Engine/Loudspeaker/Model.h"
#include "Engine/Progress.h"

namespace excursion {

/// Whether a record can tell moves between its sections, and does not have them followed yet (Record::sectionsDrift):
/// it has periods, several levels and a known noise.
bool tellsMoves(const Record&);

/// Whether a take that leaves more leaves noise, or nearly so, once small moves between its sections are followed by
/// the model, fitted again. Not where tellsMoves() denies it.
bool sectionsExplain(Model, const Record&, int substeps = 0, const Progress& = {});

}  // namespace excursion
