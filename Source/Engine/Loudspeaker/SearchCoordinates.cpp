// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/SearchCoordinates.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace excursion {
namespace {

/// The least size of an even parameter.
double nearest(const Parameter& p) { return 1e-3 * p.prior; }

template <class Of>
Eigen::VectorXd ofEach(const std::vector<Parameter*>& parameters, const Of& of)
{
    Eigen::VectorXd result(static_cast<Eigen::Index>(parameters.size()));
    std::transform(parameters.begin(), parameters.end(), result.begin(), [&](const Parameter* p) { return of(*p); });
    return result;
}

}  // namespace

void leaveZero(Parameter& p)
{
    if (p.even)
        p.value = std::copysign(std::max(std::abs(p.value), nearest(p)), p.value);
}

SearchCoordinates::SearchCoordinates(std::vector<Parameter*> parameters) : parameters_(std::move(parameters)) {}

Eigen::VectorXd SearchCoordinates::now() const
{
    return ofEach(parameters_, [](const Parameter& p) { return p.even ? p.value * p.value : p.value; });
}

Eigen::VectorXd SearchCoordinates::lower() const
{
    return ofEach(parameters_, [](const Parameter& p) {
        if (p.even)
            return nearest(p) * nearest(p);
        // Mass, inductance and their like stay away from zero, where the equations of motion are singular.
        return p.lower == 0.0 && !p.strength ? 1e-3 * p.value : p.lower;
    });
}

Eigen::VectorXd SearchCoordinates::upper() const
{
    return ofEach(parameters_, [](const Parameter& p) { return p.even ? p.upper * p.upper : p.upper; });
}

void SearchCoordinates::place(const Eigen::VectorXd& at)
{
    for (std::size_t k = 0; k < parameters_.size(); ++k) {
        auto& p = *parameters_[k];
        const double q = at[static_cast<Eigen::Index>(k)];
        p.value = p.even ? std::copysign(std::sqrt(q), p.value) : q;
    }
}

Eigen::VectorXd SearchCoordinates::slopes() const
{
    return ofEach(parameters_, [](const Parameter& p) { return p.even ? 0.5 / p.value : 1.0; });
}

void SearchCoordinates::convert(NormalEquations& sum, double variance) const
{
    if (sum.g.size() == 0)
        return;
    for (std::size_t k = 0; k < parameters_.size(); ++k) {
        const auto place = static_cast<Eigen::Index>(k);
        if (const auto& p = *parameters_[k]; p.even)
            sum.N(place, place) = std::max(0.0, sum.N(place, place) - variance / (p.prior * p.prior));
    }
    const Eigen::VectorXd s = slopes();
    sum.N = s.asDiagonal() * sum.N * s.asDiagonal();
    sum.g = s.cwiseProduct(sum.g);
}

}  // namespace excursion
