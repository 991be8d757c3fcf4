// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Datasheet/KnownScale.h"

#include "Engine/Error.h"

#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace excursion {
namespace {

constexpr double defaultArea = 0.01;  // m^2, of Radiation

bool massIsHeld(const Model& model) { return model.electrical() && !model.baseParameter("m").free; }

/// The power of the unit of length with which a parameter's number goes; an area that is not free is in true metres.
int lengthPower(const Parameter& p)
{
    static constexpr std::array powers {std::pair {"kg", -2},  std::pair {"N s/m", -2}, std::pair {"N/m", -2},
                                        std::pair {"N/A", -1}, std::pair {"N", -1},     std::pair {"s/m", -1},
                                        std::pair {"1/m", -1}, std::pair {"m", 1}};
    if (p.unit == "m^2")
        return p.free ? -1 : 0;
    for (const auto& [unit, power] : powers)
        if (p.unit == unit)
            return power;
    return 0;
}

void requirePositive(const std::optional<double>& value, const char* what)
{
    if (value && !(*value > 0.0 && std::isfinite(*value)))
        throw Error(Error::Kind::usage, std::string("The ") + what + " must be a positive number.");
}

}  // namespace

Model withMotion(Model model, double factor)
{
    std::vector<double> by;
    for (auto* p : parametersOf(model)) {
        by.push_back(std::pow(factor, lengthPower(*p)));
        p->value *= by.back();
        p->standardError *= by.back();
    }
    for (std::size_t k = 1; k < model.components.size(); ++k) {
        auto& component = model.components[k];
        component.operatingRange.displacement *= factor;
        component.operatingRange.velocity *= factor;
        if (const auto base = component.effect->sizedBy(); !base.empty())
            component.operatingRange.scale *= std::pow(factor, lengthPower(model.baseParameter(base)));
    }
    if (model.covariance.size() > 0) {
        const Eigen::Map<const Eigen::VectorXd> scale(by.data(), static_cast<Eigen::Index>(by.size()));
        model.covariance = (scale.asDiagonal() * model.covariance * scale.asDiagonal()).eval();
        model.inverseCurvature.resize(0, 0);
    }
    tellHosts(model);
    return model;
}

ScaledModel withKnown(Model model, const KnownScale& known)
{
    requirePositive(known.mass, "moving mass");
    requirePositive(known.forceFactor, "force factor");
    requirePositive(known.coneArea, "area of the cone");
    const bool scaled = known.mass || known.forceFactor;
    if (known.mass && known.forceFactor)
        throw Error(Error::Kind::usage,
                    "The force factor follows from the moving mass by what the coil shows; give one of the two.");
    if (scaled && !massIsHeld(model))
        throw Error(
            Error::Kind::usage,
            model.electrical()
                ? "The take has shown the moving mass itself: a known mass or force factor is for a model of voltage "
                  "and current alone."
                : "The model has no coil: its mass follows from force and motion.");
    const bool guessed = massIsHeld(model) && !scaled;
    if (scaled) {
        const double times = known.mass ? std::sqrt(model.baseParameter("m").value / *known.mass)
                                        : model.baseParameter("Bl").value / *known.forceFactor;
        model = withMotion(std::move(model), times);
    }

    auto& area = model.path.parameters[0];
    if (known.coneArea) {
        area.value = *known.coneArea;
        area.standardError = std::numeric_limits<double>::quiet_NaN();
        area.free = false;
        if (model.covariance.size() > 0) {
            const auto place = firstParameterOf(model, model.components.size());
            model.covariance.row(place).setZero();
            model.covariance.col(place).setZero();
            model.inverseCurvature.resize(0, 0);
        }
    }
    const bool noArea = !known.coneArea && !area.free && area.value == defaultArea;
    return {std::move(model), guessed, noArea};
}

}  // namespace excursion
