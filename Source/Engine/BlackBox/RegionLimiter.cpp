// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/BlackBox/RegionLimiter.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

constexpr double holdTime = 0.05, releaseTime = 0.3;  // s

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
      converter_(sampleRate, box.linear.sampleRate, box.stimulus.highest()),
      peak_(box.stimulus.peak),
      decay_(std::exp(-1.0 / (releaseTime * sampleRate))),
      x_(linear_.states()),
      z_(linear_.seen() + 1),
      none_(linear_.combinations(), 0.0),
      place_(static_cast<std::size_t>(region.centre.size())),
      whiten_(region.W),
      hold_(static_cast<int>(std::max(std::lround(holdTime * sampleRate), 1L)))
{
    white_.resize(whiten_.rows());
    reset();
}

void RegionLimiter::reset()
{
    converter_.reset();
    std::fill(x_.begin(), x_.end(), 0.0);
    hold_.reset();
    level_ = 1.0;
    out_ = latest_ = 0.0;
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

double RegionLimiter::step(double sample)
{
    latest_ = levelOf(sample);
    const double held = hold_.step(latest_);
    level_ = std::max({1.0, held, 1.0 + decay_ * (level_ - 1.0)});
    return 1.0 / level_;
}

}  // namespace excursion
