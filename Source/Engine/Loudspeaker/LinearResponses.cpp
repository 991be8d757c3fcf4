// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/LinearResponses.h"

#include <utility>

namespace excursion {
namespace {

constexpr int usualPoints = 12, finePoints = 48;  // an octave

}  // namespace

LinearResponses::LinearResponses(std::vector<ResponseTarget> usual, std::vector<ResponseTarget> fine)
    : usual_(std::move(usual)), fine_(std::move(fine))
{
}

LinearResponses::LinearResponses(const Record& record)
    : LinearResponses(linearResponsesOf(record, usualPoints), linearResponsesOf(record, finePoints))
{
}

LinearResponses LinearResponses::ofAllLevels(const Record& record)
{
    return {responsesOf(record, -1, usualPoints), responsesOf(record, -1, finePoints)};
}

const std::vector<ResponseTarget>& LinearResponses::gridFor(const Component& component) const
{
    return component.effect->parts(component.operatingRange).empty() ? usual_ : fine_;
}

}  // namespace excursion
