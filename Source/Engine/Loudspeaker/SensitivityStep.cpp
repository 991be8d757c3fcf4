// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/SensitivityStep.h"

#include "Engine/Numerics/TallProduct.h"

#include <algorithm>

namespace excursion {

/// The laws' derivatives at a state, and what the linear part's parameters change there.
void SensitivityStep::look(const double* z, const double* memory, double u, Instant& at)
{
    const auto states = motion_.A_.rows();
    y_.head<ExponentialStep::motions>().noalias() = motion_.C_ * Eigen::Map<const Eigen::VectorXd>(z, states);
    std::copy_n(memory, motion_.lawPlace_.size(), y_.data() + ExponentialStep::motions);

    Balance<double> sum;
    std::size_t counted = motion_.laws_.size();  // the law whose values have been added last
    for (auto& chunk : chunks_) {
        const auto& law = motion_.laws_[chunk.law];
        Jet motion[3] {Jet(y_[0]), Jet(y_[1]), Jet(y_[2])};
        for (std::size_t k = 0; k < chunk.memory.size(); ++k)
            chunk.memory[k] = Jet(y_[ExponentialStep::motions + law.memory + static_cast<Eigen::Index>(k)]);
        for (std::size_t lane = 0; lane < jetWidth; ++lane)
            if (const int q = chunk.output[lane]; q != none)
                (q < 3 ? motion[q] : chunk.memory[static_cast<std::size_t>(q - ExponentialStep::motions - law.memory)])
                    .v[static_cast<Eigen::Index>(lane)] = 1.0;
        chunk.sum = {};
        law.component->effect->contribute(law.component->operatingRange, chunk.coefficients.data(),
                                          {motion[0], motion[1], motion[2]}, chunk.memory.data(), chunk.rate.data(),
                                          chunk.sum);
        if (counted != chunk.law) {
            sum.inductance += chunk.sum.inductance.a;
            sum.fluxSlope += chunk.sum.fluxSlope.a;
            sum.drop += chunk.sum.drop.a;
            sum.force += chunk.sum.force.a;
            sum.mass += chunk.sum.mass.a;
            counted = chunk.law;
        }
    }
    // Rates g of the linear part and f of the whole.
    const double L0 = motion_.inductance_, m0 = motion_.mass_, m = m0 + sum.mass, v = y_[2];
    // what is kept of the inductance, with its slopes by what laws add and by that at rest
    const auto kept = motion_.electrical_ ? keptInductance(Tangent(L0 + sum.inductance, Eigen::Vector2d(1.0, 1.0)),
                                                           Tangent(L0, Eigen::Vector2d(0.0, 1.0)))
                                          : Tangent(1.0);
    const double L = kept.a, byLaw = kept.v[0], byRest = kept.v[1];
    const double gi = motion_.electrical_ ? y_[3] + u / L0 : 0.0, gv = y_[4] + motion_.motion(u);
    const double fi = motion_.electrical_ ? (L0 * gi - sum.drop - sum.fluxSlope * v) / L : 0.0,
                 fv = (m0 * gv + sum.force) / m;

    at.Ny.setZero();
    at.Ntheta.setZero();
    at.memory.setZero();
    for (const auto& chunk : chunks_)
        for (std::size_t lane = 0; lane < jetWidth; ++lane) {
            if (chunk.output[lane] == none && chunk.parameter[lane] == none)
                break;
            const auto k = static_cast<Eigen::Index>(lane);
            auto row = chunk.output[lane] != none ? at.Ny.row(chunk.output[lane])
                                                  : at.Ntheta.row(chunk.parameter[lane]);
            if (motion_.electrical_)
                row[0] -= (chunk.sum.drop.v[k] + chunk.sum.fluxSlope.v[k] * v + fi * byLaw * chunk.sum.inductance.v[k])
                          / L;
            row[1] += (chunk.sum.force.v[k] - fv * chunk.sum.mass.v[k]) / m;
            const bool stands = motion_.slowStands_ && motion_.laws_[chunk.law].slow > 0;
            for (std::size_t j = 0; j < chunk.rate.size() && !stands; ++j)
                row[ExponentialStep::rates + motion_.laws_[chunk.law].memory + static_cast<Eigen::Index>(j)] +=
                    chunk.rate[j].v[k];
        }
    if (motion_.electrical_) {
        at.Ny(2, 0) -= sum.fluxSlope / L;
        at.Ny(3, 0) += L0 / L - 1.0;
    }
    at.Ny(4, 1) += m0 / m - 1.0;

    // By a parameter of the linear part: f_i = (L0 g_i - ...)/L, f_v = (m0 g_v + ...)/m.
    for (const auto& entry : entries_) {
        const double rate = entry.value * (entry.column < states ? z[entry.column] : u);
        if (entry.row == 0)
            at.Ntheta(entry.parameter, 0) += L0 / L * rate;
        else if (entry.row == 2)
            at.Ntheta(entry.parameter, 1) += m0 / m * rate;
        else if (entry.row > 2)
            at.memory(entry.parameter, place_[static_cast<std::size_t>(entry.row)]) += rate;
    }
    for (const auto c : linearParameters_) {
        at.Ntheta(c, 0) += (gi - byRest * fi) * dInductance_[c] / L;
        at.Ntheta(c, 1) += (gv - fv) * dMass_[c] / m;
    }
}

void SensitivityStep::begin(const Eigen::VectorXd& z, const Eigen::MatrixXd& S)
{
    motion_.begin(z);
    const auto& linear = motion_.linearPlace_;
    const auto& laws = motion_.lawPlace_;
    S_.setZero(padded(count_), z.size());
    S_.topLeftCorner(count_, static_cast<Eigen::Index>(linear.size())) = S(Eigen::all, linear);
    S_.topRightCorner(count_, static_cast<Eigen::Index>(laws.size())) = S(Eigen::all, laws);
    fresh_ = true;
}

void SensitivityStep::letSlowStand(bool stands)
{
    motion_.letSlowStand(stands);
    fresh_ = true;  // its slopes are others now
}

void SensitivityStep::slopesByState(Eigen::MatrixXd& out) const
{
    out.resize(count_, order());
    Eigen::Index from = 0;
    for (const auto* places : {&motion_.linearPlace_, &motion_.lawPlace_})
        for (const auto place : *places)
            out.col(place) = S_.col(from++).head(count_);
}

void SensitivityStep::step(std::span<const double> u)
{
    constexpr auto motions = ExponentialStep::motions, rates = ExponentialStep::rates;
    const auto outputs = y_.size(), laws = motion_.N_[0].size(), lawMemories = laws - rates, n = motion_.A_.rows(),
               memories = memoryStage_.rows();
    const auto [middle, end] = ExponentialStep::later(u);
    const double* const z = motion_.z_.data();
    if (fresh_)
        look(z, z + n, u[0], start_);
    fresh_ = false;
    remembered_ = motion_.z_.tail(lawMemories);
    acceleration_ = motion_.step(u);
    middle_.setZero();
    toHalfway_.addTo(middle_.data(), motion_.from_.data());
    middle_.head(n).noalias() += motion_.Q_ * motion_.N_[2].head<rates>();
    remembered_ += 0.5 * step_ * motion_.N_[2].tail(lawMemories);
    look(middle_.data(), remembered_.data(), middle, halfway_);
    look(z, z + n, end, end_);

    const auto add = [this](const double* X, Eigen::Index inner, const Eigen::MatrixXd& W, double* Y) {
        addTallProduct(X, S_.rows(), inner, W.data(), W.cols(), Y, 0, S_.rows());
    };
    run_.setZero();
    const auto moving = motion_.moving_;
    const auto column = [this](Eigen::Index k) { return run_.data() + k * run_.rows(); };
    add(S_.data(), moving, carryMoving_, run_.data());
    add(S_.data(), n, carryFollowing_, column(moving));
    add(S_.data(), moving, carryMotions_, column(n));
    const auto remembered = S_.rightCols(lawMemories);  // stands still but for the laws: no exponential is needed
    auto atEnd = run_.leftCols(n), half = run_.middleCols(n + 2, motions);
    // i, x and v are among the states.
    now_ << S_.leftCols(3), run_.middleCols(n, 2);
    later_ << run_.leftCols(3), run_.rightCols(2);
    if (memories > 0) {
        const auto addMemory = [&](const Eigen::MatrixXd& memory, const double* W, Eigen::Index columns, double* Y) {
            addTallProduct(memory.data(), S_.rows(), memories, W, columns, Y, memoryFrom_, memoryTo_);
        };
        twice_ = 2.0 * halfway_.memory;
        addMemory(halfway_.memory, memoryStage_.data(), motions, half.data());
        addMemory(start_.memory, memoryQuadrature_[0].data(), n, atEnd.data());
        addMemory(twice_, memoryQuadrature_[1].data(), n, atEnd.data());
        addMemory(end_.memory, memoryQuadrature_[2].data(), n, atEnd.data());
        addMemory(start_.memory, memoryLater_.data(), motions, later_.data());
        twice_ -= start_.memory;
        addMemory(twice_, memoryStage_.data(), motions, later_.data());
    }
    // The stages of ExponentialStep, for the derivatives.
    auto& [K1, K2, K3, K4] = stage_;
    // from motions (their memories are in Y_) to K
    const auto drive = [&](const auto& motion, Eigen::MatrixXd& K, const Instant& at) {
        Y_.leftCols(motions) += motion;
        K = at.Ntheta;
        add(Y_.data(), outputs, at.Ny, K.data());
    };
    const auto stageFrom = [&](const Eigen::MatrixXd& K) {
        Y_.leftCols(motions).setZero();
        add(K.data(), rates, stageWeights_, Y_.data());
        Y_.rightCols(lawMemories) = remembered + 0.5 * step_ * K.rightCols(lawMemories);
    };
    Y_.leftCols(motions).setZero();
    Y_.rightCols(lawMemories) = remembered;
    drive(now_, K1, start_);
    accelerationSlopes_ = now_.col(4).head(count_) + K1.col(1).head(count_);
    stageFrom(K1);
    drive(half, K2, halfway_);
    stageFrom(K2);
    drive(half, K3, halfway_);
    Y_.leftCols(motions).setZero();
    add(K1.data(), rates, laterWeights_, Y_.data());
    K_.leftCols(rates) = 2.0 * K3.leftCols(rates) - K1.leftCols(rates);
    add(K_.data(), rates, stageWeights_, Y_.data());
    Y_.rightCols(lawMemories) = remembered + step_ * K3.rightCols(lawMemories);
    drive(later_, K4, end_);
    K_.leftCols(rates) = K1.leftCols(rates);
    K_.middleCols(rates, rates) = K2.leftCols(rates) + K3.leftCols(rates);
    K_.rightCols(rates) = K4.leftCols(rates);
    S_.rightCols(lawMemories) += step_ / 6.0 * (K1 + 2.0 * (K2 + K3) + K4).rightCols(lawMemories);
    S_.leftCols(n) = atEnd;
    add(K_.data(), 3 * rates, quadratureWeights_, S_.data());
    std::swap(start_, end_);
}

}  // namespace excursion
