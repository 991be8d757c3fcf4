// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Estimate/Record.h"
#include "Engine/Loudspeaker/ShownMotion.h"

#include <cstddef>
#include <vector>

namespace excursion {

/// The motions of some sections of a record, one per section.
using ShownMotions = std::vector<ShownMotion>;

/// Motions of the sections as the take shows them. Where it shows nothing, they are what the model expects from the
/// motions `before`, or without these, from its linear part.
ShownMotions shownMotions(const Model&, const Record&, const std::vector<std::size_t>& sections,
                          const ShownMotions& before = {}, unsigned threads = 1);
/// The same, first from the linear part and then once more from that result.
ShownMotions settledMotions(const Model&, const Record&, const std::vector<std::size_t>& sections,
                            unsigned threads = 1);

/// Whether one is the other but for a hundredth of the rms, in current, displacement and what they change by, in every
/// section.
bool isNear(const ShownMotions&, const ShownMotions&);

}  // namespace excursion
