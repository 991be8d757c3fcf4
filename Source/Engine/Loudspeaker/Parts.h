// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/FitResponse.h"

#include <vector>

namespace excursion {

/// Whether a component's part has any strength.
bool isAtWork(const Component&, const Part&);
/// The component with all of its parts at rest but one.
Component withOnly(const Part&, Component);
/// Puts a part at rest: its strengths are zero, and a fit does not move it.
void rest(Component&, const Part&);

/// How much of what is left a part must take away: more than chance does at the best of a hundred places.
double worthwhile(double left, const std::vector<ResponseTarget>&);

/// The newest effect taken up part by part, see Effect::parts(), from none. Those that do not pay are at rest, and not
/// free where others do.
SearchSummary fitParts(Model&, const std::vector<Part>&, const std::vector<ResponseTarget>&);

/// Those of its parts at rest that pay besides the ones that are at work, which stay where they lead. Without a part
/// that is implausible by itself, where others are left.
SearchSummary fitMoreParts(Model&, const std::vector<Part>&, const std::vector<ResponseTarget>&);

}  // namespace excursion
