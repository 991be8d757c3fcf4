// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Loudspeaker/Record.h"
#include "Engine/Loudspeaker/ShownMotion.h"

#include <cstddef>
#include <vector>

namespace excursion {

/// The motions of some sections of a record, one each.
using ShownMotions = std::vector<ShownMotion>;

/// Whether the sections of a record are periods, which is what motions are told of.
bool hasPeriods(const Record&);

/// Motions of the sections as the take shows them, and where it shows nothing as the model expects them from the
/// motions `before`; without these from its linear part.
ShownMotions shownMotions(const Model&, const Record&, const std::vector<std::size_t>& sections,
                          const ShownMotions& before = {}, unsigned threads = 1);
/// The same, from the linear part and once more from there.
ShownMotions settledMotions(const Model&, const Record&, const std::vector<std::size_t>& sections,
                            unsigned threads = 1);

}  // namespace excursion
