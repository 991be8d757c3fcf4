// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Ranking/Rank.h"
#include "Report/Page.h"

#include <string>

namespace excursion {

/// "-61.0" typeset; an en dash where it is not known, or not finite.
std::string decibelsCell(double);

/// The classes of models of a ranking side by side, and what it is worth to invert them.
void addRankingOfClasses(Page&, const Ranking&);

}  // namespace excursion
