// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Radiator.h"

#include <algorithm>

namespace excursion {
Radiator::Radiator(const Model& model, std::span<const Eigen::Index> active) : model_(model)
{
    struct Placed {
        const Component* component;
        std::vector<Eigen::Index> places;
        int memory;
    };
    std::vector<Placed> emitting {{&model_.path, placesOf(model_, model_.components.size()), 0}};
    for (std::size_t k = 0; k < model_.components.size(); ++k) {
        const auto& component = model_.components[k];
        if (component.effect->emits())
            emitting.push_back({&component, placesOf(model_, k), order_});
        order_ += component.effect->memorySize(component.operatingRange);
    }

    for (const auto& [component, places, memory] : emitting) {
        const auto& effect = *component->effect;
        const auto memories = static_cast<std::size_t>(effect.memorySize(component->operatingRange));
        parts_.push_back({component, static_cast<std::size_t>(memory), coefficientsOf(*component, valuesOf(*component)),
                          std::vector<double>(memories)});
        if (active.empty())
            continue;

        struct Direction {
            int place = none;
            std::size_t own = 0;
            int column = none;
        };
        std::vector<Direction> directions;
        for (int q = 0; q < 3; ++q)
            directions.push_back({q, 0, none});
        directions.push_back({order_, 0, none});
        for (int k = 0; k < static_cast<int>(memories); ++k)
            directions.push_back({memory + k, 0, none});
        for (std::size_t c = 0; c < active.size(); ++c)
            if (const auto own = std::find(places.begin(), places.end(), active[c]); own != places.end())
                directions.push_back({none, static_cast<std::size_t>(own - places.begin()), static_cast<int>(c)});
        for (std::size_t first = 0; first < directions.size(); first += jetWidth) {
            Chunk chunk;
            chunk.part = parts_.size() - 1;
            auto parameters = valuesOf<Jet>(*component);
            for (std::size_t lane = 0; lane < jetWidth && first + lane < directions.size(); ++lane) {
                const auto& direction = directions[first + lane];
                chunk.place.push_back(direction.place);
                chunk.column.push_back(direction.column);
                if (direction.column != none)
                    parameters[direction.own].v[static_cast<Eigen::Index>(lane)] = 1.0;
            }
            chunk.coefficients = coefficientsOf(*component, parameters);
            chunk.memory.resize(memories);
            chunk.rates.resize(memories);
            chunks_.push_back(std::move(chunk));
        }
    }
    slopes_.setZero(static_cast<Eigen::Index>(active.size()), 4);
}

double Radiator::area()
{
    const std::vector<double> rest(static_cast<std::size_t>(order_), 0.0);
    return sum(rest.data(), 0.0).area;
}

Radiator::Sound Radiator::at(const double* z, double acceleration)
{
    const auto emission = sum(z, acceleration);
    return {emission.area * emission.acceleration, emission.lateness, emission.spot};
}

Emission<double> Radiator::sum(const double* z, double acceleration)
{
    const Motion<double> motion {z[0], z[1], z[2]};
    Emission<double> sum;
    for (auto& part : parts_) {
        const auto& [effect, operatingRange, parameters] = *part.component;
        Balance<double> unused;
        if (!part.rates.empty())
            effect->contribute(operatingRange, part.coefficients.data(), motion, z + part.memory, part.rates.data(),
                               unused);
        effect->emit(operatingRange, part.coefficients.data(), motion, acceleration, z + part.memory, part.rates.data(),
                     sum);
    }
    return sum;
}

void Radiator::differentiate(const double* z, double acceleration, const Eigen::Ref<const Eigen::MatrixXd>& S,
                             const Eigen::Ref<const Eigen::VectorXd>& accelerationSlopes,
                             Eigen::Ref<Eigen::MatrixXd, 0, Eigen::OuterStride<>> out)
{
    slopes_.setZero();
    double area = 0.0, driven = 0.0;
    std::size_t counted = parts_.size();  // the part whose values have been added last
    for (auto& chunk : chunks_) {
        const auto& part = parts_[chunk.part];
        const auto& [effect, operatingRange, parameters] = *part.component;
        Jet motion[3] {Jet(z[0]), Jet(z[1]), Jet(z[2])}, a(acceleration);
        for (std::size_t k = 0; k < chunk.memory.size(); ++k)
            chunk.memory[k] = Jet(z[part.memory + k]);
        for (std::size_t lane = 0; lane < chunk.place.size(); ++lane)
            if (const int place = chunk.place[lane]; place != none)
                (place == order_ ? a
                 : place < 3     ? motion[place]
                                 : chunk.memory[static_cast<std::size_t>(place) - part.memory])
                    .v[static_cast<Eigen::Index>(lane)] = 1.0;
        const Motion<Jet> at {motion[0], motion[1], motion[2]};
        Balance<Jet> unused;
        if (!chunk.rates.empty())
            effect->contribute(operatingRange, chunk.coefficients.data(), at, chunk.memory.data(), chunk.rates.data(),
                               unused);
        Emission<Jet> sum;
        effect->emit(operatingRange, chunk.coefficients.data(), at, a, chunk.memory.data(), chunk.rates.data(), sum);
        if (counted != chunk.part) {
            area += sum.area.a;
            driven += sum.acceleration.a;
            counted = chunk.part;
        }
        for (std::size_t lane = 0; lane < chunk.place.size(); ++lane) {
            const auto k = static_cast<Eigen::Index>(lane);
            const Eigen::RowVector4d by {sum.area.v[k], sum.acceleration.v[k], sum.lateness.v[k], sum.spot.v[k]};
            if ((by.array() == 0.0).all())
                continue;
            if (const int place = chunk.place[lane]; place == none)
                slopes_.row(chunk.column[lane]) += by;
            else if (place == order_)
                slopes_.noalias() += accelerationSlopes * by;
            else
                slopes_.noalias() += S.col(place) * by;
        }
    }
    out.col(0) = driven * slopes_.col(0) + area * slopes_.col(1);
    out.col(1) = slopes_.col(2);
    out.col(2) = slopes_.col(3);
}

}  // namespace excursion
