// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/ExponentialAdams.h"

#include "Engine/Numerics/Exponential.h"

#include <algorithm>
#include <cmath>

namespace excursion {

ExponentialAdams::ExponentialAdams(const Model& model, double h, bool corrected)
    : motion_(model, h), corrected_(corrected)
{
    constexpr auto rates = ExponentialStep::rates, terms = Eigen::Index {ExponentialStep::terms};
    const auto& A = motion_.A_;
    const auto states = A.rows(), moving = motion_.moving_, following = states - moving;
    Eigen::MatrixXd end(states, states + inputs + 3 * rates), missed(states, rates);
    end.leftCols(states + inputs) = motion_.whole_.leftCols(states + inputs);
    for (Eigen::Index q = 0; q < rates; ++q) {
        const auto phi = exponential(A, motion_.E_.col(q), h, 4).phi;
        for (Eigen::Index k = 0; k < 3; ++k)
            end.col(states + inputs + k * rates + q) = std::tgamma(static_cast<double>(k) + 1.0) * phi.col(k);
        missed.col(q) = (phi.col(1) + 3.0 * (phi.col(2) + phi.col(3))) / 3.0;  // s (s + 1) (s + 2)/6
    }
    static_assert(inputs <= terms);
    const auto withAccelerations = [&](const Eigen::MatrixXd& map) {
        Eigen::MatrixXd result(states + 2, map.cols());
        result << map.topRows(moving), motion_.C_.bottomRows(2) * map, map.bottomRows(following);
        return result;
    };
    carry_ = TiledProduct(motion_.arranged(withAccelerations(end)));
    correct_ = TiledProduct(withAccelerations(missed));
    from_.assign(static_cast<std::size_t>(end.cols()), 0.0);
    run_.assign(static_cast<std::size_t>(carry_.rows()), 0.0);
    state_.setZero(motion_.order());
    missed_.setZero(motion_.N_[0].size());
    for (auto& N : past_)
        N.setZero(motion_.N_[0].size());
}

void ExponentialAdams::reset()
{
    motion_.z_.setZero();
    for (auto& N : past_)
        N.setZero();
}

std::span<double> ExponentialAdams::slow(const Effect& effect)
{
    for (const auto& law : motion_.laws_)
        if (law.component->effect == &effect && law.slow > 0)
            return {motion_.z_.data() + motion_.A_.rows() + law.memory, static_cast<std::size_t>(law.slow)};
    return {};
}

const Eigen::VectorXd& ExponentialAdams::state()
{
    motion_.state(state_);
    return state_;
}

double ExponentialAdams::step(std::span<const double> u)
{
    constexpr auto rates = ExponentialStep::rates, motions = ExponentialStep::motions;
    const auto moving = motion_.moving_, states = motion_.A_.rows(), following = states - moving;
    auto &now = past_[0], &before = past_[1], &earlier = past_[2];
    auto& y = motion_.y_;
    double* const z = motion_.z_.data();
    double* const memory = z + states;
    const auto memories = motion_.z_.size() - states;
    const double end = ExponentialStep::later(u).second;

    // the parabola in powers of s: N_n,
    const auto rise = [&](Eigen::Index k) { return 0.5 * (now[k] - 2.0 * before[k] + earlier[k]); };
    // D + D2/2 and D2/2
    const auto slope = [&](Eigen::Index k) { return now[k] - before[k] + rise(k); };
    std::copy_n(z, moving, from_.begin());
    const auto input = from_.begin() + moving, parabola = input + inputs;
    std::fill(std::copy(u.begin(), u.end(), input), parabola, 0.0);
    for (Eigen::Index q = 0; q < rates; ++q) {
        parabola[q] = now[q];
        parabola[rates + q] = slope(q);
        parabola[2 * rates + q] = rise(q);
    }
    std::copy_n(z + moving, following, parabola + 3 * rates);
    std::fill(run_.begin(), run_.end(), 0.0);
    carry_.addTo(run_.data(), from_.data());
    for (Eigen::Index k = 0; k < memories; ++k)
        memory[k] += motion_.step_ * (now[rates + k] + 1.0 / 2.0 * slope(rates + k) + 1.0 / 3.0 * rise(rates + k));
    const auto lookAtEnd = [&] {
        const double* const accelerations = run_.data() + moving;
        y.head<motions>() << run_[0], run_[1], run_[2], accelerations[0], accelerations[1];
        std::copy_n(memory, memories, y.data() + motions);
    };
    if (corrected_) {
        lookAtEnd();
        motion_.ask(end, missed_.data());
        missed_ -= 3.0 * (now - before) + earlier;
        correct_.addTo(run_.data(), missed_.data());
        for (Eigen::Index k = 0; k < memories; ++k)
            memory[k] += 3.0 / 8.0 * motion_.step_ * missed_[rates + k];
    }
    std::copy_n(run_.begin(), moving, z);
    std::copy_n(run_.begin() + moving + 2, following, z + moving);
    lookAtEnd();
    earlier.swap(before);
    before.swap(now);
    motion_.ask(end, now.data());
    return y[4] + now[1] + motion_.motion(end);
}

}  // namespace excursion
