// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/ExponentialStep.h"

#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Numerics/Exponential.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

/// The states that act on those that lead, in the end: what is in the row of a state acts on it.
std::vector<bool> acting(const Eigen::MatrixXd& A, Eigen::Index lead)
{
    std::vector<bool> acts(static_cast<std::size_t>(A.rows()), false);
    std::fill_n(acts.begin(), lead, true);
    for (bool more = true; more;) {
        more = false;
        for (Eigen::Index row = 0; row < A.rows(); ++row)
            for (Eigen::Index column = 0; acts[static_cast<std::size_t>(row)] && column < A.cols(); ++column)
                if (A(row, column) != 0.0 && !acts[static_cast<std::size_t>(column)])
                    acts[static_cast<std::size_t>(column)] = more = true;
    }
    return acts;
}

/// What a polynomial's coefficients on the step make of the states.
Eigen::MatrixXd ofCoefficients(Eigen::MatrixXd phi, double length)
{
    for (Eigen::Index k = 0; k < phi.cols(); ++k)
        phi.col(k) *= std::tgamma(static_cast<double>(k) + 1.0) * std::pow(length, k);
    return phi;
}

}  // namespace

/// What is neither felt nor remembers anything is left to those who listen.
bool ExponentialStep::isLaw(const Component& component)
{
    const auto& effect = *component.effect;
    return !effect.linear() && (effect.felt() || effect.memorySize(component.operatingRange) > 0);
}

ExponentialStep::ExponentialStep(const Model& model, double h)
    : model_(model), electrical_(model.electrical()), step_(h)
{
    linearPlace_ = {0, 1, 2};
    Eigen::Index n = 3;
    Balance<double> atRest;
    for (const auto& component : model_.components) {
        const Eigen::Index size = component.effect->memorySize(component.operatingRange);
        auto coefficients = coefficientsOf(component, valuesOf(component));
        auto& places = component.effect->linear() ? linearPlace_ : lawPlace_;
        if (component.effect->linear()) {
            const std::vector<double> memory(static_cast<std::size_t>(size), 0.0);
            std::vector<double> unused(memory);
            component.effect->contribute(component.operatingRange, coefficients.data(), {0.0, 0.0, 0.0}, memory.data(),
                                         unused.data(), atRest);
        } else if (isLaw(component)) {
            laws_.push_back({&component, std::move(coefficients), static_cast<Eigen::Index>(places.size()),
                             component.effect->slow() ? size : 0});
        }
        for (Eigen::Index k = 0; k < size; ++k)
            places.push_back(n++);
    }
    inductance_ = atRest.inductance;
    mass_ = atRest.mass;
    byVoltage_ = electrical_ ? 1.0 / inductance_ : 0.0;

    const auto part = smallSignal(linearPart(model));
    const auto acts = acting(part.A, 3);
    std::vector<Eigen::Index> order;
    for (const bool moves : {true, false}) {
        for (std::size_t k = 0; k < acts.size(); ++k)
            if (acts[k] == moves)
                order.push_back(static_cast<Eigen::Index>(k));
        if (moves)
            moving_ = static_cast<Eigen::Index>(order.size());
    }
    const std::vector<Eigen::Index> places = linearPlace_;
    std::transform(order.begin(), order.end(), linearPlace_.begin(),
                   [&](Eigen::Index k) { return places[static_cast<std::size_t>(k)]; });
    A_ = part.A(order, order);
    const Eigen::VectorXd B = part.B(order);
    const auto states = A_.rows(), following = states - moving_;
    C_.setZero(motions, states);
    C_.topLeftCorner(3, 3).setIdentity();
    C_.row(3) = A_.row(0);
    C_.row(4) = A_.row(2);
    E_.setZero(states, rates);
    E_(0, 0) = E_(2, 1) = 1.0;

    auto whole = exponential(A_, B, h, terms), half = exponential(A_, B, 0.5 * h, terms);
    for (auto* map : {&whole, &half})
        map->decay.topRightCorner(moving_, following).setZero();  // but for rounding it is
    whole_.resize(states, states + terms);
    whole_ << whole.decay, ofCoefficients(whole.phi, 1.0);
    halfway_.resize(states, states + terms);
    halfway_ << half.decay, ofCoefficients(half.phi, 0.5);
    quadrature_.resize(states, 3 * rates);
    Q_.resize(states, rates);
    for (Eigen::Index q = 0; q < rates; ++q) {
        const auto weights = quadrature(A_, E_.col(q), h);
        for (Eigen::Index point = 0; point < 3; ++point)
            quadrature_.col(point * rates + q) = weights.col(point);
        Q_.col(q) = exponential(A_, E_.col(q), 0.5 * h, 1).phi;
    }
    stage_ = C_ * Q_;
    last_ = C_ * (half.decay * Q_);

    const auto accelerations = C_.bottomRows(2);
    Eigen::MatrixXd carry = Eigen::MatrixXd::Zero(states + motions + 4, states + terms),
                    drive = Eigen::MatrixXd::Zero(carry.rows(), 3 * rates);
    carry.topRows(moving_) = whole_.topRows(moving_);
    carry.block(moving_, 0, 2, states) = accelerations;
    carry.middleRows(moving_ + 2, motions) = C_ * halfway_;
    carry.middleRows(moving_ + 2 + motions, 2) = accelerations * whole_;
    carry.bottomRows(following) = whole_.bottomRows(following);
    drive.topRows(moving_) = quadrature_.topRows(moving_);
    drive.bottomRows(following) = quadrature_.bottomRows(following);
    carry_ = TiledProduct(arranged(carry));
    drive_ = TiledProduct(drive);
    from_.assign(static_cast<std::size_t>(states + terms), 0.0);
    run_.assign(static_cast<std::size_t>(carry_.rows()), 0.0);
    const auto memories = static_cast<Eigen::Index>(lawPlace_.size());
    z_.setZero(states + memories);
    y_.setZero(motions + memories);
    for (auto& N : N_)
        N.setZero(rates + memories);
}

Eigen::MatrixXd ExponentialStep::arranged(const Eigen::MatrixXd& map) const
{
    const auto states = A_.cols();
    Eigen::MatrixXd result(map.rows(), map.cols());
    result << map.leftCols(moving_), map.rightCols(map.cols() - states), map.middleCols(moving_, states - moving_);
    return result;
}

void ExponentialStep::begin(const Eigen::VectorXd& z)
{
    double* own = z_.data();
    for (const auto* places : {&linearPlace_, &lawPlace_})
        for (const auto place : *places)
            *own++ = z[place];
}

void ExponentialStep::state(Eigen::VectorXd& z) const
{
    z.resize(z_.size());
    const double* own = z_.data();
    for (const auto* places : {&linearPlace_, &lawPlace_})
        for (const auto place : *places)
            z[place] = *own++;
}

/// N at y_.
void ExponentialStep::ask(double u, double* N)
{
    Balance<double> sum;
    for (const auto& law : laws_) {
        law.component->effect->contribute(law.component->operatingRange, law.coefficients.data(), {y_[0], y_[1], y_[2]},
                                          y_.data() + motions + law.memory, N + rates + law.memory, sum);
        if (slowStands_)
            std::fill_n(N + rates + law.memory, law.slow, 0.0);
    }
    // The linear part's drop is u - L A_i z - u, its force m A_v z; the whole drop and force act on the whole
    // inductance and mass.
    const double L = keptInductance(inductance_ + sum.inductance, inductance_);
    N[0] = electrical_ ? (inductance_ * y_[3] + u - sum.drop - sum.fluxSlope * y_[2]) / L - y_[3] - u * byVoltage_
                       : 0.0;
    const double force = mass_ * (y_[4] + motion(u));
    N[1] = (force + sum.force) / (mass_ + sum.mass) - y_[4] - motion(u);
}

std::pair<double, double> ExponentialStep::later(std::span<const double> u)
{
    double middle = 0.0, end = 0.0;
    for (std::size_t k = u.size(); k-- > 0;) {
        middle = 0.5 * middle + u[k];
        end += u[k];
    }
    return {middle, end};
}

double ExponentialStep::step(std::span<const double> u)
{
    const auto states = A_.rows(), following = states - moving_, memories = z_.size() - states;
    const auto [middle, end] = later(u);
    double* const z = z_.data();
    double* const memory = z + states;
    std::copy_n(z, moving_, from_.begin());
    std::fill(std::copy(u.begin(), u.end(), from_.begin() + moving_), from_.begin() + moving_ + terms, 0.0);
    std::copy_n(z + moving_, following, from_.begin() + moving_ + terms);
    std::fill(run_.begin(), run_.end(), 0.0);
    carry_.addTo(run_.data(), from_.data());
    const double* const atStart = run_.data() + moving_;
    const Motions halfway = Eigen::Map<const Motions>(atStart + 2);
    Motions atEnd;
    atEnd << run_[0], run_[1], run_[2], atStart[2 + motions], atStart[3 + motions];

    auto& [N1, N2, N3, N4] = N_;
    const auto lookAt = [&](const Motions& motion, double time, const Eigen::VectorXd& N) {
        y_.head<motions>() = motion;
        for (Eigen::Index k = 0; k < memories; ++k)
            y_[motions + k] = memory[k] + time * N[rates + k];
    };
    y_.head<motions>() << z[0], z[1], z[2], atStart[0], atStart[1];
    y_.tail(memories) = z_.tail(memories);
    ask(u[0], N1.data());
    lookAt(halfway + stage_ * N1.head<rates>(), 0.5 * step_, N1);
    ask(middle, N2.data());
    lookAt(halfway + stage_ * N2.head<rates>(), 0.5 * step_, N2);
    ask(middle, N3.data());
    lookAt(atEnd + last_ * N1.head<rates>() + stage_ * (2.0 * N3.head<rates>() - N1.head<rates>()), step_, N3);
    ask(end, N4.data());

    const double acceleration = atStart[1] + N1[1] + motion(u[0]);
    Eigen::Matrix<double, 3 * rates, 1> sums;
    sums << N1.head<rates>(), N2.head<rates>() + N3.head<rates>(), N4.head<rates>();
    drive_.addTo(run_.data(), sums.data());
    std::copy_n(run_.begin(), moving_, z);
    std::copy_n(run_.begin() + moving_ + motions + 4, following, z + moving_);
    for (Eigen::Index k = 0; k < memories; ++k)
        memory[k] += step_ / 6.0 * (N1[rates + k] + 2.0 * (N2[rates + k] + N3[rates + k]) + N4[rates + k]);
    return acceleration;
}

}  // namespace excursion
