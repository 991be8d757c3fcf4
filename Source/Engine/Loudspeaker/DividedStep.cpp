// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/DividedStep.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace excursion {
namespace {

using Polynomial = std::array<double, ExponentialStep::terms>;

/// The coefficients of p(s + 1), by Horner's scheme.
void shiftByOne(Polynomial& p)
{
    for (std::size_t first = 0; first + 1 < p.size(); ++first)
        for (std::size_t k = p.size() - 1; k-- > first;)
            p[k] += p[k + 1];
}

}  // namespace

DividedStep::DividedStep(const Model& model, const StepDivision& division, double h)
    : division_(division), steps_(model, h), now_(&steps_[0])
{
}

void DividedStep::begin(const Eigen::VectorXd& z)
{
    now_->begin(z);
    before_ = current();
}

void DividedStep::letSlowStand(bool stands)
{
    slowStands_ = stands;
    now_->letSlowStand(stands);
}

void DividedStep::goOnWith(int power)
{
    auto& next = steps_[power];
    next.letSlowStand(slowStands_);
    next.takeOver(*now_);
    now_ = &next;
    power_ = power;
}

double DividedStep::step(std::span<const double> u)
{
    // The current may go far within a step; the cone does not.
    const double i = current(), x = displacement(), v = velocity();
    const int power = std::max(division_.power(i, x, v), division_.power(2.0 * i - before_, x, v));
    before_ = i;
    if (power != power_)
        goOnWith(power);
    if (power == 0)
        return now_->step(u);
    Polynomial part {};
    for (std::size_t k = 0; k < u.size(); ++k)
        part[k] = std::ldexp(u[k], -power * static_cast<int>(k));
    const double acceleration = now_->step(part);
    for (int n = 1; n < 1 << power; ++n) {
        shiftByOne(part);
        now_->step(part);
    }
    return acceleration;
}

}  // namespace excursion
