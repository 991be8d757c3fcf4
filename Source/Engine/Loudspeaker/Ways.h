// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/FitResponse.h"

namespace excursion {

/// What a search of the newest effect has come to.
struct Way {
    Model model;
    double cost;
};

inline bool cheaper(const Way& a, const Way& b) { return a.cost < b.cost; }

/// What can be the effect comes before what has been bent to stand for something else, and then what leaves less.
inline bool better(const Way& a, const Way& b)
{
    const auto plausible = [](const Model& model) { return isPlausible(model, model.components.size() - 1); };
    const bool first = plausible(a.model), second = plausible(b.model);
    return first != second ? first : a.cost < b.cost;
}

}  // namespace excursion
