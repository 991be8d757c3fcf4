// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/Cone.h"

#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Predistortion/Cubic.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {
namespace {

constexpr double shareTime = 0.003;  // s, see Glide

/// Steps a sample, at most 64, for which the laws' fastest eigenvalue times the step stays within the limit.
int stepsWithin(double limit, const Model& model, double sampleRate)
{
    const double fastest = ExponentialStep(model, 1.0 / sampleRate).fastestLaw();
    return static_cast<int>(std::clamp(std::ceil(fastest / (limit * sampleRate)), 1.0, 64.0));
}

/// s, after which the resonances of a linear driver have forgotten how they began; a second at most.
double settlingTime(const SmallSignal& linear)
{
    constexpr double timeConstants = 7.0, longest = 1.0;
    double slowest = std::numeric_limits<double>::infinity();
    for (const auto& pole : poles(linear))
        if (std::abs(pole.imag()) > std::abs(pole.real()))
            slowest = std::min(slowest, std::abs(pole.real()));
    return std::min(timeConstants / slowest, longest);
}

}  // namespace

Cone::Cone(const Model& model, double sampleRate)
    : corrected_(stepsWithin(ExponentialAdams::stable, model, sampleRate) > 1),
      substeps_(corrected_ ? stepsWithin(ExponentialAdams::stableCorrected, model, sampleRate) : 1),
      motion_(model, 1.0 / (sampleRate * substeps_), corrected_),
      plausible_(model),
      reference_(model, sampleRate),
      radiator_(model),
      area_(radiator_.area()),
      share_(shareTime, sampleRate)
{
    const auto linear = smallSignal(linearPart(model));  // as in Reference
    settling_ = static_cast<int>(settlingTime(linear) * sampleRate);
    linear_ = (linear.C.row(SmallSignal::sound) * reference_.basis()).transpose() / area_;
    linearInput_ = linear.D[SmallSignal::sound] / area_;
}

void Cone::rest()
{
    motion_.reset();
    past_ = {};
    reference_.reset();
    left_ = 0;
}

void Cone::reset()
{
    rest();
    share_.jump(asked_);
}

void Cone::warm(const Warmth& warmth)
{
    for (const auto& memory : warmth.slow)
        if (memory.effect)
            if (const auto slow = motion_.slow(*memory.effect); slow.size() <= memory.value.size())
                std::copy_n(memory.value.begin(), slow.size(), slow.begin());
}

void Cone::setLinearShareRemoved(double share)
{
    if (share >= 0.0 && share <= 1.0)
        asked_ = share;
}

/// What is subtracted.
double Cone::linearShare(double u)
{
    if (asked_ == 0.0 && share_.still() && share_.value() == 0.0) {
        left_ = settling_ + 1;
        return 0.0;
    }
    if (left_ > settling_)
        reference_.reset();
    reference_.step(u);
    if (left_ > 0 && --left_ > 0)
        return 0.0;
    share_.aim(asked_);
    const double share = share_.step();
    return share * (linear_.dot(reference_.state()) + linearInput_ * u);
}

bool Cone::step(double& sample)
{
    const double u = sample;
    const auto drive = Cubic::through(past_[2], past_[1], past_[0], u);
    double acceleration = 0.0;
    for (int s = 0; s < substeps_; ++s)
        acceleration = motion_.step(drive.part(static_cast<double>(s) / substeps_, 1.0 / substeps_).c);
    past_ = {u, past_[0], past_[1]};
    const double linear = linearShare(u);
    sample = radiator_.at(motion_.state().data(), acceleration).flow / area_ - linear;
    if (plausible_.holds(motion_.current(), motion_.displacement(), motion_.velocity()) && std::isfinite(acceleration)
        && std::isfinite(linear))
        return true;
    rest();
    sample = 0.0;
    return false;
}

}  // namespace excursion
