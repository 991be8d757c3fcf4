// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/Record.h"
#include "Engine/Loudspeaker/Model.h"
#include "Engine/Progress.h"

namespace excursion {

/// Whether a take that leaves more leaves noise, or nearly so, once small moves between its sections are followed
/// (Record::sectionsDrift) by the model, fitted again. Not of a record in which they are, nor of one without several
/// levels and a known noise.
bool sectionsExplain(Model, const Record&, int substeps = 0, const Progress& = {});

}  // namespace excursion
