// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/LinearResponses.h"

#include <functional>
#include <vector>

namespace excursion {

// These only check Progress for cancellation; they report nothing.

/// Finds linear effects of a model anew, one after the other, on the responses of the record without laws: no small
/// step leads from a wrong shape to the right one. True if one is kept.
/// @param still  responses of the record without the model's laws (withoutLaws())
/// @param which  the effects to find
/// @param keeps  fits what was found with all the rest, and tells whether it stays
bool findAnew(Model&, const LinearResponses& still, const std::function<bool(const Component&)>& which,
              const std::function<bool(Model& anew)>& keeps);

/// Brings shapes of linear effects back on trial that have shrunk to nothing while laws were missing: where all cells
/// of a relaxation are one every slope by its shape is zero, and no search leaves that place. True if that leaves
/// 0.2 % less; the model then had a quick fit.
bool wakeShapes(Model&, const Record&, const std::vector<std::size_t>& sections, const FitOptions&,
                const Progress& = {});

/// Finds effects that relax anew where they depart from their law farther than is plausible, in a usual shape: another
/// may look the same in every linear response, and bend the laws beside it. True if that leaves 0.2 % less; the model
/// then had a quick fit. Does nothing for a record without periods.
bool findUsualShapes(Model&, const Record&, const std::vector<std::size_t>& sections, const FitOptions&,
                     const Progress& = {});

/// Wakes shapes, and then searches again for linear effects that have several parts, as newly known effects may have
/// uncovered more parts. True if something leaves 5 % less; the model then had a quick fit. Does nothing for a record
/// without periods.
bool findPartsAnew(Model&, const Record&, const std::vector<std::size_t>& sections, const FitOptions&,
                   const Progress& = {});

}  // namespace excursion
