// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/Memory.h"

#include "Engine/Numerics/Exponential.h"
#include "Engine/Predistortion/CubicDrive.h"

#include <algorithm>
#include <cmath>

namespace excursion {

Memory::Memory(const Effect& effect, const OperatingRange& operatingRange, std::vector<double> coefficients,
               double sampleRate)
    : effect_(&effect),
      operatingRange_(operatingRange),
      coefficients_(std::move(coefficients)),
      period_(1.0 / sampleRate),
      size_(static_cast<std::size_t>(effect.memorySize(operatingRange)))
{
    for (auto* place : {&value_, &rate_, &byCurrent_, &next_, &before_})
        place->assign(size_, 0.0);
    for (auto& stage : stages_)
        stage.assign(size_, 0.0);
    if (const auto linear = linearRates(effect, operatingRange, coefficients_.data()))
        prepareLinear(*linear, sampleRate);
    else if (findDriven(sampleRate))
        kind_ = Kind::driven;
}

void Memory::rates(double i, double x, double v, const double* m, double* out) const
{
    Balance<double> unused;
    effect_->contribute(operatingRange_, coefficients_.data(), {i, x, v}, m, out, unused);
}

void Memory::prepareLinear(const LinearRates& linear, double sampleRate)
{
    kind_ = Kind::linear;
    for (Eigen::Index q = 0; q < 3; ++q) {
        const auto [decay, phi] = exponential(linear.A, linear.b.col(q), 1.0 / sampleRate, 4);
        const Eigen::MatrixXd G = byCoefficients(phi);
        for (Eigen::Index k = 0; k < 4; ++k)
            drive_[static_cast<std::size_t>(4 * q + k)].assign(G.col(k).data(), G.col(k).data() + G.rows());
        decay_.assign(decay.data(), decay.data() + decay.size());
    }
    for (std::size_t k = 0; k < size_; ++k)
        byCurrent_[k] = 0.5 * (drive_[2][k] + drive_[3][k]);  // what Cubic::past makes of its end
}

/// Whether r = -diag(p) m + N, with an N by which memories of their usual size carry one on little within a step.
bool Memory::findDriven(double sampleRate)
{
    constexpr double little = 0.1;  // of the memory: what is foretold badly of it is ten times less wrong then
    const auto n = static_cast<Eigen::Index>(size_);
    Eigen::VectorXd m = Eigen::VectorXd::Zero(n), r(n), atRest(n);
    rates(0.0, 0.0, 0.0, m.data(), atRest.data());
    Eigen::MatrixXd A(n, n);
    for (Eigen::Index k = 0; k < n; ++k) {
        m = Eigen::VectorXd::Unit(n, k);
        rates(0.0, 0.0, 0.0, m.data(), r.data());
        A.col(k) = r - atRest;
    }
    if (!(A.allFinite() && A.isDiagonal(0.0) && (A.diagonal().array() < 0.0).all()))
        return false;
    for (int trial = 1; trial <= 4; ++trial) {
        const auto visited = [trial](double most, double phase) { return most * std::sin(1.0 + 2.3 * trial + phase); };
        const double i = visited(operatingRange_.current, 0.0), x = visited(operatingRange_.displacement, 1.7),
                     v = visited(operatingRange_.velocity, 3.4);
        Eigen::VectorXd forgotten(n);
        m.setZero();
        rates(i, x, v, m.data(), forgotten.data());
        m = -forgotten.cwiseQuotient(A.diagonal());  // as large as this motion makes it, in the end
        rates(i, x, v, m.data(), r.data());
        if (!(((r - A * m - forgotten) / sampleRate).array().abs() <= little * m.array().abs()).all())
            return false;
    }
    const auto [decay, phi] = exponential(A, Eigen::VectorXd::Ones(n), 1.0 / sampleRate, 4);
    const Eigen::MatrixXd weights = bySamples(phi);
    for (std::size_t sample = 0; sample < 4; ++sample) {
        const auto column = weights.col(static_cast<Eigen::Index>(sample));
        weight_[sample].assign(column.data(), column.data() + n);
        N_[sample].assign(size_, 0.0);
    }
    const Eigen::VectorXd own = A.diagonal(), kept = decay.diagonal();
    own_.assign(own.data(), own.data() + n);
    decay_.assign(kept.data(), kept.data() + n);
    kind_ = Kind::driven;
    reset();
    return true;
}

void Memory::reset()
{
    const std::vector<double>& nothing = stages_[0];
    std::fill(stages_[0].begin(), stages_[0].end(), 0.0);
    set(nothing.data());
}

void Memory::set(const double* value)
{
    std::copy_n(value, size_, value_.begin());
    before_ = value_;
    end_ = {};
    if (kind_ != Kind::driven)
        return;
    auto& first = N_.front();
    rates(0.0, 0.0, 0.0, value_.data(), first.data());
    for (std::size_t k = 0; k < size_; ++k)
        first[k] -= own_[k] * value_[k];
    for (auto& N : N_)
        N = first;
}

void Memory::approach(const Memory& other, double share)
{
    for (std::size_t k = 0; k < size_; ++k)
        value_[k] += share * (other.value_[k] - value_[k]);
}

void Memory::drift(double i, double x, double v, double seconds)
{
    rates(i, x, v, value_.data(), rate_.data());
    for (std::size_t k = 0; k < size_; ++k)
        value_[k] += seconds * rate_[k];
}

void Memory::step(const MotionCubic& motion)
{
    end_ = {motion.i.end(), motion.x.end(), motion.v.end()};
    std::copy(value_.begin(), value_.end(), before_.begin());
    switch (kind_) {
    case Kind::linear: return stepLinear(motion);
    case Kind::driven: return stepDriven();
    case Kind::any: return stepAny(motion);
    }
}

void Memory::stepBack()
{
    std::copy(before_.begin(), before_.end(), value_.begin());
    newest_ = (newest_ + 3) % 4;  // what it overwrote, three samples before, is not asked for
}

void Memory::stepLinear(const MotionCubic& motion)
{
    std::fill(next_.begin(), next_.end(), 0.0);
    for (std::size_t column = 0; column < size_; ++column)
        for (std::size_t row = 0; row < size_; ++row)
            next_[row] += decay_[column * size_ + row] * value_[column];
    const Cubic* const cubics[3] = {&motion.i, &motion.x, &motion.v};
    for (std::size_t c = 0; c < 12; ++c)
        for (std::size_t k = 0; k < size_; ++k)
            next_[k] += drive_[c][k] * cubics[c / 4]->c[c % 4];
    std::swap(value_, next_);
}

void Memory::stepDriven()
{
    const auto& last = N_[newest_];
    const auto& second = N_[(newest_ + 3) % 4];
    const auto& third = N_[(newest_ + 2) % 4];
    newest_ = (newest_ + 1) % 4;
    auto& N = N_[newest_];
    for (std::size_t k = 0; k < size_; ++k) {
        next_[k] = 3.0 * (last[k] - second[k]) + third[k];
        value_[k] = decay_[k] * value_[k] + weight_[0][k] * next_[k] + weight_[1][k] * last[k]
                    + weight_[2][k] * second[k] + weight_[3][k] * third[k];
    }
    rates(end_[0], end_[1], end_[2], value_.data(), N.data());
    for (std::size_t k = 0; k < size_; ++k) {
        N[k] -= own_[k] * value_[k];
        value_[k] += weight_[0][k] * (N[k] - next_[k]);
    }
}

void Memory::stepAny(const MotionCubic& motion)
{
    auto &k1 = stages_[0], &k2 = stages_[1], &k3 = stages_[2], &k4 = stages_[3], &y = stages_[4];
    const auto ask = [&](double s, const double* m, std::vector<double>& out) {
        rates(motion.i.at(s), motion.x.at(s), motion.v.at(s), m, out.data());
    };
    const auto towards = [&](const std::vector<double>& slope, double fraction) {
        for (std::size_t k = 0; k < size_; ++k)
            y[k] = value_[k] + fraction * period_ * slope[k];
    };
    ask(0.0, value_.data(), k1);
    towards(k1, 0.5);
    ask(0.5, y.data(), k2);
    towards(k2, 0.5);
    ask(0.5, y.data(), k3);
    towards(k3, 1.0);
    ask(1.0, y.data(), k4);
    for (std::size_t k = 0; k < size_; ++k)
        value_[k] += period_ / 6.0 * (k1[k] + 2.0 * (k2[k] + k3[k]) + k4[k]);
}

double Memory::dropPerCurrent()
{
    Balance<double> sum;
    effect_->contribute(operatingRange_, coefficients_.data(), {1.0, 0.0, 0.0}, value_.data(), stages_[0].data(), sum);
    return sum.drop;
}

const double* Memory::findRate()
{
    if (kind_ == Kind::driven)
        for (std::size_t k = 0; k < size_; ++k)
            rate_[k] = own_[k] * value_[k] + N_[newest_][k];
    else
        rates(end_[0], end_[1], end_[2], value_.data(), rate_.data());
    return rate_.data();
}

void Memory::correct(double current)
{
    for (std::size_t k = 0; k < size_; ++k)
        value_[k] += byCurrent_[k] * current;
}

}  // namespace excursion
