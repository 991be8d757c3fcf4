// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/FitResponse.h"

#include <vector>

namespace excursion {

/// The responses of a record that are nearest to those of a linear driver (linearResponsesOf()), on the grids that
/// searches for linear effects use. Made once for all effects that are searched on one record.
class LinearResponses {
public:
    explicit LinearResponses(const Record&);

    /// On the grid that this effect needs: 12 points an octave, or 48 where it is found part by part.
    const std::vector<ResponseTarget>& gridFor(const Component&) const;

private:
    std::vector<ResponseTarget> usual_, fine_;
};

}  // namespace excursion
