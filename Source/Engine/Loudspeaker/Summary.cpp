// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Summary.h"

#include <algorithm>
#include <cmath>

namespace excursion {

std::vector<Figure> figuresOf(const Model& model, std::size_t component)
{
    const auto& c = model.components.at(component);
    const auto values = valuesOf(c);
    auto figures = c.effect->summary(c.operatingRange, values.data());
    if (figures.empty() || model.covariance.size() == 0)
        return figures;
    const auto first = firstParameterOf(model, component);
    const auto widened = widenedCovariance(model);
    const auto count = static_cast<Eigen::Index>(c.parameters.size());
    Eigen::MatrixXd gradient = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(figures.size()), count);
    for (Eigen::Index j = 0; j < count; ++j) {
        const auto k = static_cast<std::size_t>(j);
        const double deviation = std::sqrt(widened(first + j, first + j));
        if (deviation == 0.0)  // held, or of no importance
            continue;
        const double step = 1e-3 * std::min(deviation, std::max(std::abs(values[k]), c.parameters[k].prior));
        const auto moved = [&](double by) {
            auto at = values;
            at[k] += by;
            return c.effect->summary(c.operatingRange, at.data());
        };
        const auto above = moved(step), below = moved(-step);
        if (above.size() != figures.size() || below.size() != figures.size())
            continue;  // at the brink of being there at all
        for (std::size_t n = 0; n < figures.size(); ++n)
            gradient(static_cast<Eigen::Index>(n), j) = (above[n].value - below[n].value) / (2.0 * step);
    }
    const Eigen::MatrixXd covariance = gradient * widened.block(first, first, count, count) * gradient.transpose();
    for (std::size_t n = 0; n < figures.size(); ++n)
        figures[n].standardError = std::sqrt(covariance(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n)));
    return figures;
}

}  // namespace excursion
