// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Plausible.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {

Plausible::Plausible(const Model& model)
{
    constexpr double far = 1e6, infinity = std::numeric_limits<double>::infinity();
    Eigen::Array3d visited = Eigen::Array3d::Zero(), byLaws = visited;
    for (const auto& component : model.components) {
        if (&component == &model.base())
            continue;  // it was measured nowhere in particular
        const Eigen::Array3d reach(component.operatingRange.current, component.operatingRange.displacement,
                                   component.operatingRange.velocity);
        visited = visited.max(reach);
        if (!component.effect->linear())
            byLaws = byLaws.max(reach);
    }
    most_ = (byLaws > 0.0).select(far * byLaws, infinity);
    const auto part = [&model](const char* name) { return model.baseParameter(name).value; };
    const double input = model.electrical() ? std::max(part("Re") * visited[0], part("Bl") * visited[2])
                                            : std::max(part("K") * visited[1], part("Rms") * visited[2]);
    // The square of any input is to be a finite number.
    input_ = input > 0.0 ? far * input : std::sqrt(std::numeric_limits<double>::max());
}

}  // namespace excursion
