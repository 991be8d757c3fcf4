// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/OddForce.h"

#include "Bench/Random.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion::bench {
namespace {

constexpr double leapTime = 0.02;   // s, a leap from rest to rest
constexpr double longest = 3600.0;  // s of play for which leaps are drawn

// Bouc-Wen in one step of Heun's method per third of a step: the steps are short against its bend.
double follow(const Oddity& o, double z, double v, double h)
{
    const auto rate = [&](double at) {
        const double turned = v * at >= 0.0 ? 1.0 : -1.0;
        return v * (1.0 - (o.pinch * turned + 1.0 - o.pinch) * std::pow(std::abs(at) / o.limit, o.exponent));
    };
    const double first = rate(z);
    return z + 0.5 * h * (first + rate(z + h * first));
}

}  // namespace

OddForce::OddForce(const Oddity& oddity, double step) : oddity_(oddity), h_(step)
{
    Random random(oddity.seed);
    if (oddity.kind == Oddity::Kind::wander) {
        constexpr int count = 6;
        for (int n = 0; n < count; ++n) {
            amplitude_.push_back(oddity.depth * std::sqrt(2.0 / count));
            angular_.push_back(2.0 * std::numbers::pi * random.logUniform(0.03, 0.6));
            phase_.push_back(random.uniform(0.0, 2.0 * std::numbers::pi));
        }
    }
    if (oddity.kind == Oddity::Kind::jump)
        for (double time = random.logUniform(0.3, 3.0); time < longest; time += random.logUniform(0.3, 3.0))
            leaps_.push_back(time);
}

double OddForce::course(double time) const
{
    double value = 0.0;
    for (std::size_t n = 0; n < amplitude_.size(); ++n)
        value += amplitude_[n] * std::sin(angular_[n] * time + phase_[n]);
    if (leaps_.empty())
        return value;
    const auto next = std::upper_bound(leaps_.begin(), leaps_.end(), time);
    const auto past = next - leaps_.begin();
    if (past == 0)
        return 0.0;
    const double share = std::min(1.0, (time - leaps_[static_cast<std::size_t>(past - 1)]) / leapTime);
    const double eased = 0.5 - 0.5 * std::cos(std::numbers::pi * share);
    return oddity_.depth * (past % 2 == 1 ? eased : 1.0 - eased);
}

Triple OddForce::force(const Triple& x, const Triple& v)
{
    Triple result {};
    double z = state_, before = 0.0;
    for (int j = 0; j < 3; ++j) {
        const double at = Radau::points()[j];
        switch (oddity_.kind) {
        case Oddity::Kind::contact: {
            const double pressed = oddity_.side * x[j] - oddity_.gap;
            result[j] = pressed > 0.0 ? -oddity_.side * oddity_.stiffness * std::pow(pressed, 1.5) : 0.0;
            break;
        }
        case Oddity::Kind::wander: result[j] = -oddity_.stiffness * course(time_ + at * h_) * x[j]; break;
        case Oddity::Kind::hysteresis:
            z = follow(oddity_, z, v[j], (at - before) * h_);
            before = at;
            result[j] = -oddity_.stiffness * z;
            break;
        case Oddity::Kind::jump: result[j] = oddity_.stiffness * course(time_ + at * h_); break;
        }
    }
    next_ = z;
    return result;
}

void OddForce::finish()
{
    state_ = next_;
    time_ += h_;
}

}  // namespace excursion::bench
