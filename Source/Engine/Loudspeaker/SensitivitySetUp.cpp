// SPDX-License-Identifier: GPL-3.0-or-later
// What a step along the sensitivities needs of a model.
#include "Engine/Loudspeaker/SensitivityStep.h"

#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Numerics/Exponential.h"
#include "Engine/Numerics/TallProduct.h"

#include <algorithm>

namespace excursion {
namespace {

/// By component and value of valuesOf(): its place among the active parameters, or -1.
std::vector<std::vector<Eigen::Index>> columnsByComponent(const Model& model, std::span<const Eigen::Index> active)
{
    std::vector<std::vector<Eigen::Index>> columns(model.components.size());
    for (std::size_t k = 0; k < columns.size(); ++k)
        for (const auto place : placesOf(model, k)) {
            const auto c = std::find(active.begin(), active.end(), place);
            columns[k].push_back(c == active.end() ? -1 : c - active.begin());
        }
    return columns;
}

}  // namespace

SensitivityStep::SensitivityStep(const Model& model, double h, std::span<const Eigen::Index> active)
    : motion_(model, h), count_(static_cast<Eigen::Index>(active.size()))
{
    constexpr auto motions = ExponentialStep::motions, rates = ExponentialStep::rates;
    // with the laws' memories
    const auto states = motion_.A_.rows(), outputs = motion_.y_.size(), laws = motion_.N_[0].size();
    dInductance_.setZero(count_);
    dMass_.setZero(count_);
    memoryFrom_ = padded(count_);
    const auto columns = columnsByComponent(model, active);
    addLinear(model, columns);
    std::size_t law = 0;
    for (std::size_t n = 0; n < model.components.size(); ++n)
        if (ExponentialStep::isLaw(model.components[n]))
            addLaw(law++, columns[n]);

    const auto& C = motion_.C_;
    const Eigen::MatrixXd whole = motion_.whole_.leftCols(states), decay = motion_.halfway_.leftCols(states);
    const auto moving = motion_.moving_, following = states - moving;
    carryMoving_ = whole.topLeftCorner(moving, moving).transpose();
    carryFollowing_ = whole.bottomRows(following).transpose();
    const Eigen::MatrixXd accelerations = C.bottomRows(2), halfway = C * decay, atEnd = accelerations * whole;
    carryMotions_.resize(moving, 4 + motions);
    carryMotions_ << accelerations.leftCols(moving).transpose(), halfway.leftCols(moving).transpose(),
        atEnd.leftCols(moving).transpose();
    const auto memories = static_cast<Eigen::Index>(
        std::count_if(place_.begin(), place_.end(), [](Eigen::Index p) { return p != none; }));
    for (auto& weights : memoryQuadrature_)
        weights.resize(memories, states);
    memoryStage_.resize(memories, motions);
    memoryLater_.resize(memories, motions);
    for (Eigen::Index state = 0; state < states; ++state)
        if (const auto k = place_[static_cast<std::size_t>(state)]; k != none) {
            const Eigen::VectorXd unit = Eigen::VectorXd::Unit(states, state);
            const auto weights = quadrature(motion_.A_, unit, h);
            for (Eigen::Index point = 0; point < 3; ++point)
                memoryQuadrature_[static_cast<std::size_t>(point)].row(k) = weights.col(point).transpose();
            const Eigen::VectorXd Q = exponential(motion_.A_, unit, 0.5 * h, 1).phi;
            memoryStage_.row(k) = (C * Q).transpose();
            memoryLater_.row(k) = (C * (decay * Q)).transpose();
        }
    stageWeights_ = motion_.stage_.transpose();
    laterWeights_ = motion_.last_.transpose();
    quadratureWeights_ = motion_.quadrature_.transpose();
    toHalfway_ = TiledProduct(motion_.arranged(motion_.halfway_));
    const auto rows = padded(count_);
    step_ = h;
    for (auto* instant : {&start_, &halfway_, &end_}) {
        instant->Ny.setZero(outputs, laws);
        instant->Ntheta.setZero(rows, laws);
        instant->memory.setZero(rows, memories);
    }
    for (auto& K : stage_)
        K.setZero(rows, laws);
    middle_.setZero(toHalfway_.rows());
    remembered_.setZero(laws - rates);
    y_.setZero(outputs);
    accelerationSlopes_.setZero(count_);
    twice_.setZero(rows, memories);
    run_.setZero(rows, states + 4 + motions);
    now_.setZero(rows, motions);
    later_.setZero(rows, motions);
    Y_.setZero(rows, outputs);
    K_.setZero(rows, 3 * ExponentialStep::rates);
    S_.setZero(rows, motion_.z_.size());
}

void SensitivityStep::addLinear(const Model& model, const std::vector<std::vector<Eigen::Index>>& columnsByComponent)
{
    const auto linear = smallSignal(linearPart(model), true);
    const auto n = linear.A.rows();
    place_.assign(static_cast<std::size_t>(n), none);
    // Their order there, by that here, which is the one of the components.
    std::vector<Eigen::Index> sorted(motion_.linearPlace_), state(sorted.size());
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t k = 0; k < sorted.size(); ++k)
        state[k] = std::find(motion_.linearPlace_.begin(), motion_.linearPlace_.end(), sorted[k])
                   - motion_.linearPlace_.begin();
    Eigen::Index memories = 0;
    std::size_t k = 0;  // parameter of the linear part
    for (std::size_t place = 0; place < model.components.size(); ++place) {
        const auto& component = model.components[place];
        if (!component.effect->linear())
            continue;
        for (std::size_t own = 0; own < component.parameters.size(); ++own, ++k) {
            const auto c = columnsByComponent[place][own];
            if (c == none)
                continue;
            linearParameters_.push_back(c);
            for (Eigen::Index row = 0; row < n; ++row)
                for (Eigen::Index column = 0; column <= n; ++column)
                    if (const double value = column < n ? linear.dA[k](row, column) : linear.dB[k][row]; value != 0.0) {
                        const auto to = state[static_cast<std::size_t>(row)];
                        entries_.push_back({c, to, column < n ? state[static_cast<std::size_t>(column)] : n, value});
                        if (row < 3)
                            continue;
                        if (place_[static_cast<std::size_t>(to)] == none)
                            place_[static_cast<std::size_t>(to)] = memories++;
                        memoryFrom_ = std::min(memoryFrom_, c / tallBlock * tallBlock);
                        memoryTo_ = std::max(memoryTo_, padded(c + 1));
                    }
            auto parameters = valuesOf<Jet>(component);
            parameters[own].v[0] = 1.0;
            const auto coefficients = coefficientsOf(component, parameters);
            std::vector<Jet> memory(static_cast<std::size_t>(component.effect->memorySize(component.operatingRange)),
                                    Jet(0.0)),
                unused(memory);
            Balance<Jet> atRest;
            component.effect->contribute(component.operatingRange, coefficients.data(), {Jet(0.0), Jet(0.0), Jet(0.0)},
                                         memory.data(), unused.data(), atRest);
            dInductance_[c] = atRest.inductance.v[0];
            dMass_[c] = atRest.mass.v[0];
        }
    }
}

void SensitivityStep::addLaw(std::size_t law, const std::vector<Eigen::Index>& columns)
{
    const auto& component = *motion_.laws_[law].component;
    const int memories = component.effect->memorySize(component.operatingRange);
    struct Direction {
        int output = none;
        std::size_t own = 0;  // of the values of the law
        Eigen::Index column = none;
    };
    std::vector<Direction> directions;
    for (int q = 0; q < 3; ++q)
        directions.push_back({q, 0, none});
    for (int k = 0; k < memories; ++k)
        directions.push_back({static_cast<int>(ExponentialStep::motions + motion_.laws_[law].memory) + k, 0, none});
    for (std::size_t p = 0; p < columns.size(); ++p)
        if (columns[p] != none)
            directions.push_back({none, p, columns[p]});
    for (std::size_t first = 0; first < directions.size(); first += jetWidth) {
        Chunk chunk;
        chunk.law = law;
        chunk.output.fill(none);
        chunk.parameter.fill(none);
        auto parameters = valuesOf<Jet>(component);
        for (std::size_t lane = 0; lane < jetWidth && first + lane < directions.size(); ++lane) {
            const auto& direction = directions[first + lane];
            chunk.output[lane] = direction.output;
            chunk.parameter[lane] = static_cast<int>(direction.column);
            if (direction.column != none)
                parameters[direction.own].v[static_cast<Eigen::Index>(lane)] = 1.0;
        }
        chunk.coefficients = coefficientsOf(component, parameters);
        chunk.memory.resize(static_cast<std::size_t>(memories));
        chunk.rate.resize(static_cast<std::size_t>(memories));
        chunks_.push_back(std::move(chunk));
    }
}

}  // namespace excursion
