// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linearization/Memory.h"

#include "Engine/Dispatch.h"

#include <unsupported/Eigen/MatrixFunctions>

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

EXCURSION_DISPATCH void decay(std::size_t size, const double* rates, const double* value, double* __restrict next)
{
    for (std::size_t k = 0; k < size; ++k)
        next[k] = rates[k] * value[k];
}

/// By the cubic c.
EXCURSION_DISPATCH void drive(std::size_t size, const double* w0, const double* w1, const double* w2, const double* w3, const double* c,
                              double* __restrict next)
{
    const double c0 = c[0], c1 = c[1], c2 = c[2], c3 = c[3];
    for (std::size_t k = 0; k < size; ++k)
        next[k] += w0[k] * c0 + w1[k] * c1 + w2[k] * c2 + w3[k] * c3;
}

} // namespace

Memory::Memory(const Effect& effect, const Extent& extent, std::vector<double> coefficients, double sampleRate)
    : effect_(&effect), extent_(extent), coefficients_(std::move(coefficients)), period_(1.0 / sampleRate),
      size_(static_cast<std::size_t>(effect.memorySize(extent)))
{
    for (auto* place : {&value_, &rate_, &byCurrent_, &next_, &before_})
        place->assign(size_, 0.0);
    for (auto& stage : stages_)
        stage.assign(size_, 0.0);
    if (size_ > 0)
        linear_ = probe(sampleRate);
}

void Memory::rates(double i, double x, double v, const double* m, double* out) const
{
    Balance<double> unused;
    effect_->contribute(extent_, coefficients_.data(), {i, x, v}, m, out, unused);
}

/// Finds A and b by asking for the rates at unit states, and whether they explain the rates at any other.
bool Memory::probe(double sampleRate)
{
    const auto n = static_cast<Eigen::Index>(size_);
    const double unit[3] = {extent_.current, extent_.displacement, extent_.velocity};
    Eigen::MatrixXd A(n, n), b(n, 3);
    Eigen::VectorXd m = Eigen::VectorXd::Zero(n), r(n), atRest(n);
    rates(0.0, 0.0, 0.0, m.data(), atRest.data());
    for (Eigen::Index q = 0; q < 3; ++q) {
        double at[3] = {};
        at[q] = unit[q];
        rates(at[0], at[1], at[2], m.data(), r.data());
        b.col(q) = r / unit[q];
    }
    for (Eigen::Index k = 0; k < n; ++k) {
        m.setZero();
        m[k] = 1.0;
        rates(0.0, 0.0, 0.0, m.data(), r.data());
        A.col(k) = r;
    }
    if (!(atRest.isZero(0.0) && A.allFinite() && b.allFinite()))
        return false;
    for (int trial = 1; trial <= 4; ++trial) {
        double at[3];
        for (int q = 0; q < 3; ++q)
            at[q] = unit[q] * std::sin(1.0 + 2.3 * trial + 1.7 * q);
        for (Eigen::Index k = 0; k < n; ++k)
            m[k] = std::cos(0.9 * trial + 2.1 * static_cast<double>(k));
        rates(at[0], at[1], at[2], m.data(), r.data());
        const Eigen::VectorXd expected = A * m + b * Eigen::Vector3d(at[0], at[1], at[2]);
        const Eigen::VectorXd size = A.cwiseAbs() * m.cwiseAbs() + b.cwiseAbs() * Eigen::Vector3d(at[0], at[1], at[2]).cwiseAbs();
        for (Eigen::Index k = 0; k < n; ++k)
            if (!(std::abs(r[k] - expected[k]) <= 1e-9 * size[k]))
                return false;
    }

    diagonal_ = A.isDiagonal(0.0);
    for (Eigen::Index q = 0; q < 3; ++q) {
        Eigen::MatrixXd chain = Eigen::MatrixXd::Zero(n + 4, n + 4);
        chain.topLeftCorner(n, n) = A / sampleRate;
        chain.block(0, n, n, 1) = b.col(q) / sampleRate;
        for (Eigen::Index k = 0; k < 3; ++k)
            chain(n + k, n + k + 1) = 1.0;
        const Eigen::MatrixXd solution = chain.exp();
        auto& drive = drives_[static_cast<std::size_t>(q)];
        drive.present = !b.col(q).isZero(0.0);
        double factorial = 1.0;
        for (Eigen::Index k = 0; k < 4; ++k) {
            factorial *= static_cast<double>(std::max<Eigen::Index>(k, 1));
            const Eigen::VectorXd weight = factorial * solution.block(0, n + k, n, 1);
            drive.weight[static_cast<std::size_t>(k)].assign(weight.data(), weight.data() + n);
        }
        if (q == 0) {
            const Eigen::MatrixXd decay = solution.topLeftCorner(n, n);
            for (Eigen::Index column = 0; column < n; ++column)
                for (Eigen::Index row = diagonal_ ? column : 0; row < (diagonal_ ? column + 1 : n); ++row) {
                    decay_.push_back(decay(row, column));
                }
            for (std::size_t k = 0; k < size_; ++k)
                byCurrent_[k] = 0.5 * (drive.weight[2][k] + drive.weight[3][k]);   // what Cubic::past makes of its end
        }
    }
    return true;
}

void Memory::reset()
{
    std::fill(value_.begin(), value_.end(), 0.0);
    end_ = {};
}

void Memory::step(const MotionCubic& motion)
{
    const Cubic* const cubics[3] = {&motion.i, &motion.x, &motion.v};
    end_ = {motion.i.end(), motion.x.end(), motion.v.end()};
    std::copy(value_.begin(), value_.end(), before_.begin());
    if (!linear_) {
        auto& [k1, k2, k3, k4, y] = stages_;
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
        return;
    }

    if (diagonal_) {
        decay(size_, decay_.data(), value_.data(), next_.data());
    } else {
        std::fill(next_.begin(), next_.end(), 0.0);
        for (std::size_t column = 0; column < size_; ++column)
            for (std::size_t row = 0; row < size_; ++row)
                next_[row] += decay_[column * size_ + row] * value_[column];
    }
    for (std::size_t q = 0; q < 3; ++q)
        if (const auto& [weight, present] = drives_[q]; present)
            drive(size_, weight[0].data(), weight[1].data(), weight[2].data(), weight[3].data(), cubics[q]->c.data(), next_.data());
    std::swap(value_, next_);
}

const double* Memory::findRate()
{
    rates(end_[0], end_[1], end_[2], value_.data(), rate_.data());
    return rate_.data();
}

void Memory::correct(double current)
{
    for (std::size_t k = 0; k < size_; ++k)
        value_[k] += byCurrent_[k] * current;
}

} // namespace excursion
