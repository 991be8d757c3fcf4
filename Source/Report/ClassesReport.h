// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Document/JsonField.h"
#include "Report/Page.h"

#include <string>

namespace excursion {

/// "-61.0" typeset, of a field that may be absent or null: an en dash.
std::string decibelsIn(const JsonField& object, const char* key);

/// The classes of models of a ranking side by side, and what it is worth to invert them. Throws Error (input).
void addRankingOfClasses(Page&, const JsonField& document);

}  // namespace excursion
