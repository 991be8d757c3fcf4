// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <vector>

namespace excursion {

/// The differential equations of a model, generic in the number type. State z = (i, x, v, memories of the components in
/// order); the input is the voltage, or the force for a mechanical-only driver.
///     di/dt = (u - drop - fluxSlope v) / keptInductance(inductance, inductance(0)),   dx/dt = v,
///     dv/dt = force / mass
/// The model must outlive the dynamics.
template <class T>
class Dynamics {
public:
    /// @param parameters  one value per parameter of the model, in the order of parametersOf()
    Dynamics(const Model& model, const std::vector<T>& parameters) : electrical_(model.electrical())
    {
        int coefficients = 0;
        for (const auto& component : model.components) {
            const auto& e = *component.effect;
            parts_.push_back({&e, &component.operatingRange, coefficients, order_});
            coefficients += e.coefficientCount(component.operatingRange);
            order_ += e.memorySize(component.operatingRange);
        }
        coefficients_.resize(static_cast<std::size_t>(coefficients));
        for (std::size_t k = 0; k < parts_.size(); ++k) {
            const auto& part = parts_[k];
            std::vector<T> values;
            for (const auto place : placesOf(model, k))
                values.push_back(parameters[static_cast<std::size_t>(place)]);
            part.effect->prepare(*part.operatingRange, values.data(), coefficients_.data() + part.coefficients);
        }
        const auto path = static_cast<std::size_t>(firstParameterOf(model, model.components.size()));
        path_.assign(static_cast<std::size_t>(model.path.effect->coefficientCount(model.path.operatingRange)), T(0.0));
        model.path.effect->prepare(model.path.operatingRange, parameters.data() + path, path_.data());
        radiation_ = &model.path;
        const std::vector<T> rest(static_cast<std::size_t>(order_), T(0.0));
        auto unused = rest;
        inductanceAtRest_ = balance(rest.data(), unused.data()).inductance;
    }

    int order() const { return order_; }

    /// dz/dt at state z under input u, and a force on the cone.
    void rates(const T* z, const T& u, T* dz, const T& push = T(0.0)) const
    {
        const auto sum = balance(z, dz);
        dz[1] = z[2];
        if (electrical_) {
            dz[0] = (u - sum.drop - sum.fluxSlope * z[2]) / keptInductance(sum.inductance, inductanceAtRest_);
            dz[2] = (sum.force + push) / sum.mass;
        } else {
            dz[0] = T(0.0);
            dz[2] = (sum.force + push + u) / sum.mass;
        }
    }

    /// The emission of the driver at state z with the rates dz.
    Emission<T> emission(const T* z, const T* dz) const
    {
        const Motion<T> at {z[0], z[1], z[2]};
        Emission<T> sum;
        radiation_->effect->emit(radiation_->operatingRange, path_.data(), at, dz[2], nullptr, nullptr, sum);
        for (const auto& part : parts_)
            part.effect->emit(*part.operatingRange, coefficients_.data() + part.coefficients, at, dz[2],
                              z + part.memory, dz + part.memory, sum);
        return sum;
    }

private:
    /// The sum of all contributions at a state; sets the rates of the memories.
    Balance<T> balance(const T* z, T* dz) const
    {
        Balance<T> sum;
        for (const auto& part : parts_)
            part.effect->contribute(*part.operatingRange, coefficients_.data() + part.coefficients, {z[0], z[1], z[2]},
                                    z + part.memory, dz + part.memory, sum);
        return sum;
    }

    struct Part {
        const Effect* effect;
        const OperatingRange* operatingRange;
        int coefficients;  ///< where its coefficients start
        int memory;        ///< where its memory starts in the state
    };

    bool electrical_;
    int order_ = 3;
    std::vector<Part> parts_;
    std::vector<T> coefficients_, path_;
    T inductanceAtRest_ {0.0};
    const Component* radiation_;
};

}  // namespace excursion
