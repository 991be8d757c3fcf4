// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/HeatFactor.h"

#include "Engine/Predistortion/RealTime.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

constexpr double hold = 0.05, release = 0.2, forgetting = 5.0;  // s
constexpr double underWay = 0.1;                                // s, longer than a signal is on its way
constexpr double slope = 10.0, target = 0.985;                  // of the limit
// of a mean that is above the limit: the limit that it is given
constexpr double descent = 0.96;
constexpr double largestExcess = 30.0, near = 0.3, closeLook = 0.25, tooMuch = 1.5;

}  // namespace

HeatFactor::HeatFactor(const LinearMotion& motion, double sampleRate)
    : ohms_(motion.ohms),
      byInput_(motion.currentByInput),
      share_(ticks::share(PredistortionControls::averagingTime, sampleRate)),
      forgetting_(ticks::share(forgetting, sampleRate)),
      meanSamples_(PredistortionControls::averagingTime * sampleRate),
      load_(motion, sampleRate),
      grid_(motion.holdingStep),
      holding_(motion.holding),
      unexpected_(ticks::in(underWay, sampleRate)),
      ahead_(ticks::in(hold, sampleRate)),
      expected_(ticks::in(hold, sampleRate)),
      heats_(ticks::in(hold, sampleRate)),
      factor_(release, sampleRate),
      effort_(release, sampleRate)
{
}

void HeatFactor::reset()
{
    load_.reset();
    for (auto* held : {&ahead_, &expected_, &heats_})
        held->reset();
    factor_.reset();
    effort_.reset();
    loads_ = leads_ = false;
    blind_ = 0;
    peak_ = mean_ = 0.0;
    excess_ = 1.0;
}

void HeatFactor::add(double u)
{
    if (!loads_)
        return;
    const double i = load_.step(u).i + byInput_ * u;
    peak_ = std::max(peak_, ohms_ * i * i);
}

void HeatFactor::rest(double heat, double samples) { mean_ += -std::expm1(-samples / meanSamples_) * (heat - mean_); }

double HeatFactor::decide(double limit, bool moving, double heat, double hotter, double peak, double reach)
{
    mean_ += share_ * (heat - mean_);
    const double expected = expected_.step(ahead_.value() * hotter * factor() * factor());
    // What a signal makes that came in while there was no limit was not expected, and tells nothing of the
    // linearization.
    if (!(limit > 0.0))
        blind_ = unexpected_;
    else if (blind_ > 0)
        --blind_;
    heat = heats_.step(blind_ > 0 ? 0.0 : heat);
    if (heat * limit > near && heat > excess_ * expected)
        excess_ = std::min(heat / expected, largestExcess);
    else
        excess_ += forgetting_ * (1.0 - excess_);

    // The impedance is nowhere below that of the coil, so a quiet signal needs no closer look.
    const bool close = peak * peak * limit > closeLook * ohms_;
    if (close && !loads_)
        load_.reset();
    loads_ = close;

    const auto place = grid_ > 0.0 ? static_cast<std::size_t>(
                           std::min(std::ceil(reach / grid_), static_cast<double>(holding_.size() - 1)))
                                   : 0;
    const double come = hotter * std::max(ahead_.step(peak_) * excess_, holding_[place]);
    peak_ = 0.0;
    leads_ = moving || (leads_ && mean_ * limit > target);
    const double aim = leads_ && mean_ > 0.0 ? std::min(limit / target, 1.0 / (descent * mean_)) : limit / target;
    if (!(aim > 0.0)) {
        effort_.step(1.0, moving);
        return factor_.step(1.0, moving);
    }
    const double allowed = std::max(0.0, (1.0 + slope * (1.0 - mean_ * aim)) / aim);
    effort_.step(heat > tooMuch * allowed ? std::sqrt(tooMuch * allowed / heat) : 1.0, moving);
    return factor_.step(come > allowed ? std::sqrt(allowed / come) : 1.0, moving);
}

}  // namespace excursion
