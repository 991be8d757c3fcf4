// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/BlackBox/BlackBoxSpeaker.h"

#include "Engine/Predistortion/Subnormals.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

constexpr double beyondAnything = 1000.0;              // of the peak
constexpr double shareTime = 0.005;                    // s, see Glide
constexpr double silenceTime = 0.02, riseTime = 0.05;  // s, after a fault

}  // namespace

BlackBoxSpeaker::BlackBoxSpeaker(const BlackBox& box, const Region& region, const Rest& rest, double sampleRate)
    : toModel_(sampleRate, box.linear.sampleRate),
      back_(box.linear.sampleRate, sampleRate),
      step_(box, region),
      linear_(box, region),
      rest_(rest),
      loudest_(beyondAnything * box.stimulus.peak),
      latency_(toModel_.reach() + static_cast<int>(std::ceil(back_.reach() * sampleRate / box.linear.sampleRate))
               + (toModel_.reach() > 0 ? 2 : 0)),
      x_(step_.states()),
      straight_(step_.states()),
      z_(step_.seen() + 1),
      q_(step_.combinations()),
      none_(step_.combinations(), 0.0),
      made_(static_cast<std::size_t>(latency_) + 64),
      removed_(shareTime, box.linear.sampleRate),
      recovery_(static_cast<int>(silenceTime * sampleRate) + latency_, static_cast<int>(riseTime * sampleRate)),
      still_(box.linear.C.row(0).dot(rest.x) + box.F.row(0).dot(rest.q))
{
    reset();
}

void BlackBoxSpeaker::rest()
{
    std::fill(x_.begin(), x_.end(), 0.0);
    std::copy(rest_.x.begin(), rest_.x.end(), x_.begin());
    std::fill(q_.begin(), q_.end(), 0.0);
    std::copy(rest_.q.begin(), rest_.q.end(), q_.begin());
    std::fill(straight_.begin(), straight_.end(), 0.0);
}

void BlackBoxSpeaker::reset()
{
    toModel_.reset();
    back_.reset();
    rest();
    removed_.jump();
    recovery_.reset();
    std::fill(made_.begin(), made_.end(), 0.0);
    in_ = out_ = 0;
    early_ = latency_;
}

double BlackBoxSpeaker::play(double u)
{
    step_.see(x_.data(), u, z_.data());
    furthest_ = std::max(furthest_, step_.combinationsAt(z_.data(), u, nullptr, q_.data()));
    const double y = step_.advance(x_.data(), u, q_.data());
    const double straight = linear_.advance(straight_.data(), u, none_.data());
    farthest_ = std::max(farthest_, std::abs(y - still_));
    return y - removed_.step() * straight;
}

void BlackBoxSpeaker::process(const double* in, double* out, std::size_t n)
{
    const FlushSubnormals flush;
    for (std::size_t k = 0; k < n; ++k) {
        double u = in[k];
        if (!(std::abs(u) < loudest_)) {  // also for NaN
            u = 0.0;
            rest();
            recovery_.fault();
            faults_.fetch_add(1, std::memory_order_relaxed);
        }
        toModel_.push(u);
        for (double v = 0.0; toModel_.pull(v);) {
            back_.push(play(v));
            for (double y = 0.0; back_.pull(y);) {
                made_[in_] = y;
                in_ = in_ + 1 == made_.size() ? 0 : in_ + 1;
            }
        }
        double y = 0.0;
        if (early_ > 0) {
            --early_;
        } else {
            y = made_[out_];
            out_ = out_ + 1 == made_.size() ? 0 : out_ + 1;
        }
        out[k] = withoutSubnormals(recovery_.step() * y);
    }
    region_.raise(furthest_);
    furthest_ = 0.0;
    output_.raise(farthest_);
    farthest_ = 0.0;
}

}  // namespace excursion
