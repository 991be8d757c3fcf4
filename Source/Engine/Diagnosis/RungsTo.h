// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Ladder.h"
#include "Engine/Diagnosis/Whole.h"

#include <vector>

namespace excursion {

/// The rungs that lead from the base to a whole, the largest fall of the error first. The diagnosis of each rung but
/// the last names the effect of the next one; the last is the whole itself, not compared and not diagnosed yet.
/// @param base  the first rung, compared; what its diagnosis says is said anew
std::vector<Rung> rungsTo(const Whole&, Rung base, const Record&, const DiagnoseOptions&, const Progress& = {});

}  // namespace excursion
