// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/TargetFilter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion {
namespace {

constexpr double targetTime = 0.005;    // s, see Glide
constexpr double highestTarget = 0.25;  // of the sample rate

}  // namespace

TargetFilter::TargetFilter(const OwnLinearPart& own, double sampleRate)
    : own_(own),
      equalizer_(sampleRate),
      sampleRate_(sampleRate),
      frequency_(targetTime, sampleRate),
      quality_(targetTime, sampleRate)
{
    aim({});
    reset();
}

/// Above a quarter of the sample rate the tangent is no measure any more; a driver that swings there keeps what it has.
Resonance TargetFilter::within(Resonance wanted) const
{
    const auto own = own_.played({});
    if (wanted.frequency <= highestTarget * sampleRate_ && own.frequency <= highestTarget * sampleRate_)
        return wanted;
    return own;
}

void TargetFilter::aim(const Target& target)
{
    if (!target.areSound())
        return;
    target_ = within(own_.played(target));
    frequency_.aim(std::log(target_.frequency));
    quality_.aim(std::log(target_.quality));
    settled_ = settled_ && frequency_.still() && quality_.still();
    equalizer_.aim(own_.gains(target));
}

void TargetFilter::jump()
{
    frequency_.jump();
    quality_.jump();
    set(target_);
    settled_ = true;
    equalizer_.jump();
}

void TargetFilter::reset()
{
    jump();
    first_ = second_ = 0.0;
    equalizer_.reset();
}

void TargetFilter::set(const Resonance& wanted)
{
    const auto own = own_.played({});
    const double g = std::tan(std::numbers::pi * std::min(wanted.frequency / sampleRate_, highestTarget)),
                 k = 1.0 / wanted.quality, ratio = own.frequency / wanted.frequency;
    a1_ = 1.0 / (1.0 + g * (g + k));
    a2_ = g * a1_;
    a3_ = g * a2_;
    byFirst_ = ratio / own.quality - k;
    bySecond_ = ratio * ratio - 1.0;
}

double TargetFilter::step(double u)
{
    if (!settled_) {
        const double frequency = frequency_.step(), quality = quality_.step();
        settled_ = frequency_.still() && quality_.still();
        // What is arrived at is the target itself, not what its logarithm is rounded to.
        set(settled_ ? target_ : Resonance {std::exp(frequency), std::exp(quality)});
    }
    const double high = u - second_, v1 = a1_ * first_ + a2_ * high, v2 = second_ + a2_ * first_ + a3_ * high;
    first_ = 2.0 * v1 - first_;
    second_ = 2.0 * v2 - second_;
    return equalizer_.step(u + byFirst_ * v1 + bySecond_ * v2);
}

std::complex<double> TargetFilter::at(double frequency) const
{
    const auto own = own_.played({});
    const double ft = target_.frequency, stretched = ft * std::tan(std::numbers::pi * frequency / sampleRate_)
                                                     / std::tan(std::numbers::pi * ft / sampleRate_);
    const std::complex<double> s(0.0, stretched);
    return equalizer_.at(frequency) * (s * s + s * own.frequency / own.quality + own.frequency * own.frequency)
           / (s * s + s * ft / target_.quality + ft * ft);
}

}  // namespace excursion
