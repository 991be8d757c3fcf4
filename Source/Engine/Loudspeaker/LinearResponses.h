// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/FitResponse.h"

#include <vector>

namespace excursion {

/// The responses of a record that are nearest to those of a linear driver, on the grids that searches for linear
/// effects use. Made once for all effects that are searched on one record.
class LinearResponses {
public:
    /// Of the quietest level (linearResponsesOf()), where laws that nobody knows do least.
    explicit LinearResponses(const Record&);

    /// Of all levels, where noise does least: for a record without its laws (withoutLaws()).
    static LinearResponses ofAllLevels(const Record&);

    /// On the grid that this effect needs: 12 points an octave, or 48 where it is found part by part.
    const std::vector<ResponseTarget>& gridFor(const Component&) const;

private:
    LinearResponses(std::vector<ResponseTarget> usual, std::vector<ResponseTarget> fine);

    std::vector<ResponseTarget> usual_, fine_;
};

}  // namespace excursion
