// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Ladder.h"

#include "Engine/Loudspeaker/Catalogue.h"

namespace excursion {

std::vector<KnownEffect> knownEffects(const Ladder& ladder)
{
    std::vector<KnownEffect> known;
    if (ladder.rungs.empty())
        return known;
    for (const auto& id : ladder.rungs.front().model.effectIds())
        known.push_back({id, {}});
    for (std::size_t n = 1; n < ladder.rungs.size(); ++n) {
        const auto* ranked = ladder.rungs[n - 1].diagnosis.find(ladder.rungs[n].added);
        known.push_back({ladder.rungs[n].added, ranked ? std::optional(ranked->confidence) : std::nullopt});
    }
    return known;
}

std::string foundInWords(const Ladder& ladder)
{
    std::string text;
    for (std::size_t n = 1; n < ladder.rungs.size(); ++n)
        text += (n == 1                         ? "Found: "
                 : n + 1 == ladder.rungs.size() ? " and "
                                                : ", ")
                + effectNamed(ladder.rungs[n].added).title();
    return text.empty() ? text : text + ". ";
}

}  // namespace excursion
