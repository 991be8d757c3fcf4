// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Ladder.h"
#include "Engine/Diagnosis/Whole.h"

#include <vector>

namespace excursion {

/// The rungs that lead from the base to a whole, the largest fall of the error first. The diagnosis of each rung except
/// the last names the effect of the next one. The last rung is the whole itself, compared, not yet diagnosed. None if
/// the whole runs away when it is simulated.
/// @param base  the first rung, compared; its diagnosis is made anew
std::vector<Rung> rungsTo(const Whole&, Rung base, const Record&, const DiagnoseOptions&, const Progress& = {});

}  // namespace excursion
