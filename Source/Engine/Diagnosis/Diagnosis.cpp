// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Diagnosis.h"

#include <algorithm>

namespace excursion {

std::string_view name(Verdict verdict)
{
    switch (verdict) {
    case Verdict::missingEffect: return "missing-effect";
    case Verdict::complete: return "complete";
    case Verdict::badMeasurement: return "bad-measurement";
    case Verdict::unknownEffect: break;
    }
    return "unknown-effect";
}

const RankedEffect* Diagnosis::find(std::string_view effect) const
{
    const auto found = std::find_if(ranking.begin(), ranking.end(),
                                    [&](const RankedEffect& r) { return r.effect == effect; });
    return found == ranking.end() ? nullptr : &*found;
}

}  // namespace excursion
