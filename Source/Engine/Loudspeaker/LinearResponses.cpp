// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/LinearResponses.h"

namespace excursion {

LinearResponses::LinearResponses(const Record& record)
    : usual_(linearResponsesOf(record, 12)), fine_(linearResponsesOf(record, 48))
{
}

const std::vector<ResponseTarget>& LinearResponses::gridFor(const Component& component) const
{
    return component.effect->parts(component.operatingRange).empty() ? usual_ : fine_;
}

}  // namespace excursion
