// SPDX-License-Identifier: GPL-3.0-or-later
// Whether what a fit has found is what its name says.
#include "Engine/Loudspeaker/FitResponse.h"
#include "Engine/Loudspeaker/Parts.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <vector>

namespace excursion {

bool isPlausible(const Model& model, std::size_t component)
{
    const auto& own = model.components[component];
    return own.effect->plausible(own.operatingRange, own.parameters, model.base().parameters);
}

bool isItself(const Model& model, std::size_t component)
{
    constexpr double atBound = 0.002;  // of the range
    const auto& own = model.components[component];
    return isPlausible(model, component)
           && std::none_of(own.parameters.begin(), own.parameters.end(), [](const Parameter& p) {
                  const double range = p.upper - p.lower;
                  return !p.strength && std::isfinite(range)
                         && std::min(p.value - p.lower, p.upper - p.value) < atBound * range;
              });
}

bool restImplausibleParts(Model& model, std::size_t component)
{
    auto& own = model.components[component];
    const auto& base = model.base().parameters;
    auto rested = own;
    bool stays = false, goes = false;
    for (const auto& part : own.effect->parts(own.operatingRange)) {
        const auto alone = withOnly(part, own);
        if (!isAtWork(alone))
            continue;
        if (own.effect->plausible(own.operatingRange, alone.parameters, base)) {
            stays = true;
            continue;
        }
        goes = true;
        rest(rested, part);
    }
    if (!stays || !goes)
        return false;
    own = std::move(rested);
    return true;
}

bool isSeen(const Model& model, std::size_t component)
{
    constexpr double sure = 4.0;  // standard errors, which take neighbouring points for independent
    if (model.covariance.size() == 0 || !isItself(model, component))
        return false;
    const auto first = firstParameterOf(model, component);
    const auto& parameters = model.components[component].parameters;
    std::vector<Eigen::Index> shapes, strengths;
    for (std::size_t k = 0; k < parameters.size(); ++k) {
        const auto index = first + static_cast<Eigen::Index>(k);
        if (parameters[k].strength)
            strengths.push_back(index);
        else if (model.covariance(index, index) > 0.0)
            shapes.push_back(index);
    }
    const Eigen::LDLT<Eigen::MatrixXd> known(Eigen::MatrixXd(model.covariance(shapes, shapes)));
    for (const auto index : strengths) {
        double variance = model.covariance(index, index);  // NaN where it is not known
        if (!shapes.empty()) {
            const Eigen::VectorXd shared = model.covariance(shapes, index);
            variance -= shared.dot(known.solve(shared));
        }
        if (std::abs(parameters[static_cast<std::size_t>(index - first)].value)
                > sure * std::sqrt(std::max(variance, 0.0))
            && std::isfinite(variance))
            return true;
    }
    return false;
}

}  // namespace excursion
