// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/BlackBox/RegionLimiter.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

constexpr double rampTime = 0.001, holdTime = 0.05, releaseTime = 0.3;  // s
constexpr double beyondAll = 100.0;                                     // of the peak

std::size_t samplesOf(double seconds, double rate)
{
    return static_cast<std::size_t>(std::max(std::lround(seconds * rate), 1L));
}

/// The box without what bends it, whose rest is that of the box.
BlackBox linearOf(const BlackBox& box)
{
    auto plain = box;
    plain.exponents.resize(0, box.exponents.cols());
    plain.R.resize(box.R.rows(), 0);
    return plain;
}

}  // namespace

RegionLimiter::RegionLimiter(const BlackBox& box, const Region& region, double sampleRate)
    : linear_(linearOf(box), region),
      converter_(sampleRate, box.linear.sampleRate),
      peak_(box.stimulus.peak),
      decay_(std::exp(-1.0 / (releaseTime * sampleRate))),
      x_(linear_.states()),
      z_(linear_.seen() + 1),
      none_(linear_.combinations(), 0.0),
      place_(static_cast<std::size_t>(region.centre.size())),
      whiten_(region.W),
      hold_(static_cast<int>(samplesOf(holdTime, sampleRate))),
      recovery_(static_cast<int>(samplesOf(0.05, sampleRate)), static_cast<int>(samplesOf(0.05, sampleRate))),
      gains_(samplesOf(rampTime, sampleRate)),
      delayed_(gains_.size() + static_cast<std::size_t>(converter_.reach()) + 1)
{
    white_.resize(whiten_.rows());
    reset();
}

void RegionLimiter::reset()
{
    converter_.reset();
    std::fill(x_.begin(), x_.end(), 0.0);
    hold_.reset();
    recovery_.reset();
    level_ = gain_ = 1.0;
    out_ = 0.0;
    std::fill(gains_.begin(), gains_.end(), 1.0);
    sum_ = static_cast<double>(gains_.size());
    std::fill(delayed_.begin(), delayed_.end(), 0.0);
    gainAt_ = at_ = 0;
    faulty_ = false;
}

/// What the sample is of the most that may be: of the peak, or of the way to the region's border.
double RegionLimiter::levelOf(double sample)
{
    converter_.push(sample);
    for (double u = 0.0; converter_.pull(u);) {
        linear_.see(x_.data(), u, z_.data());
        // The linear part moves around zero, the region around its mean: the way out is counted from the middle of
        // either, as that is where a signal goes that is turned down.
        for (std::size_t k = 0; k + 1 < place_.size(); ++k)
            place_[k] = z_[k];
        place_.back() = u;
        whiten_.set(place_.data(), white_.data());
        out_ = std::sqrt(innerProduct(white_.data(), white_.data(), white_.size()));
        linear_.advance(x_.data(), u, none_.data());
    }
    return std::max(std::abs(sample) / peak_, out_);
}

double RegionLimiter::step(double sample, bool on)
{
    faulty_ = !(std::abs(sample) < beyondAll * peak_);  // also for NaN
    if (faulty_) {
        recovery_.fault();
        sample = 0.0;
    }
    const double held = hold_.step(levelOf(sample));
    level_ = std::max({1.0, held, 1.0 + decay_ * (level_ - 1.0)});
    const double next = recovery_.step() * (on ? 1.0 / level_ : 1.0);
    sum_ += next - gains_[gainAt_];
    gains_[gainAt_] = next;
    gainAt_ = gainAt_ + 1 == gains_.size() ? 0 : gainAt_ + 1;
    if (gainAt_ == 0) {  // rounding does not pile up
        sum_ = 0.0;
        for (const double gain : gains_)
            sum_ += gain;
    }
    gain_ = std::clamp(sum_ / static_cast<double>(gains_.size()), 0.0, 1.0);
    const double delayed = delayed_[at_];
    delayed_[at_] = sample;
    at_ = at_ + 1 == delayed_.size() ? 0 : at_ + 1;
    return gain_ * delayed;
}

}  // namespace excursion
