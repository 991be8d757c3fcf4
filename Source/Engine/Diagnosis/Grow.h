// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/WholeSearch.h"

#include <optional>
#include <set>
#include <string>
#include <vector>

namespace excursion {

/// A model that effects were put into, what the last of them was fitted to, and how it came there.
struct Grown {
    Model model;
    FitSummary fit;
    Waypoints path;
    /// small moves between the sections of the take (WholeSearch::leftOfSections()) explain what is left, nearly or all
    /// of it, better than more effects
    bool sectionsDrift = false;
};

/// Puts the effects that the record shows into a base: by rounds of voting, beside which the law comes in that alone
/// would leave least, and where votes lead no further from other starts of its laws, or by trial of one law after the
/// other. None where that comes to where another search has been.
/// @param known  the path of the other search
std::optional<Grown> grown(const Model& base, const Record&, WholeSearch&, const Waypoints& known,
                           const Progress& = {});

/// Whether something is lost without an effect.
bool isNeeded(const Removal&);

}  // namespace excursion
