// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linearization/Speaker.h"

#include "Engine/Driver/Simulate.h"
#include "Engine/Linearization/Cubic.h"
#include "Engine/Linearization/InputGuard.h"
#include "Engine/Linearization/Subnormals.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

constexpr double implausibleState = 1e3;   // A, m, m/s, as in a simulation
constexpr double followingTime = 0.005;  // s

} // namespace

Speaker::Speaker(const Model& model, const RealTimeOptions& options)
    : oversampling_((requireRunnable(model, options), options.oversampling)),
      substeps_(stableSubsteps(model, options.sampleRate * options.oversampling, ExponentialAdams::stable)),
      motion_(model, 1.0 / (options.sampleRate * options.oversampling * substeps_)), reference_(model, options.sampleRate * options.oversampling),
      recovery_(2 * oversampling_.latency() + static_cast<int>(0.02 * options.sampleRate), static_cast<int>(0.05 * options.sampleRate)),
      smoothing_(1.0 - std::exp(-1.0 / (followingTime * options.sampleRate)))
{
}

void Speaker::rest()
{
    motion_.reset();
    past_ = {};
    reference_.reset();
}

void Speaker::reset()
{
    rest();
    oversampling_.reset();
    recovery_.reset();
    share_ = shareTarget_;
    faulty_ = false;
}

void Speaker::setLinearShareRemoved(double share)
{
    if (share >= 0.0 && share <= 1.0)
        shareTarget_ = share;
}

/// One sample of the higher rate.
double Speaker::advance(double u)
{
    const auto drive = Cubic::through(past_[2], past_[1], past_[0], u);
    double acceleration = 0.0;
    for (int s = 0; s < substeps_; ++s)
        acceleration = motion_.step(drive.part(static_cast<double>(s) / substeps_, 1.0 / substeps_).c);
    past_ = {u, past_[0], past_[1]};
    const double linear = reference_.step(u).a;
    if (!(std::abs(motion_.state()[0]) < implausibleState && std::abs(motion_.state()[1]) < implausibleState && std::abs(motion_.state()[2]) < implausibleState
          && std::isfinite(acceleration) && std::isfinite(linear))) {
        faulty_ = true;
        return 0.0;
    }
    peakCurrent_ = std::max(peakCurrent_, std::abs(motion_.state()[0]));
    peakDisplacement_ = std::max(peakDisplacement_, std::abs(motion_.state()[1]));
    return acceleration - share_ * linear;
}

void Speaker::process(const double* in, double* out, std::size_t n)
{
    const FlushSubnormals flush;
    const auto factor = static_cast<std::size_t>(oversampling_.factor());
    while (n > 0) {
        const std::size_t count = std::min(n, Oversampling::longestBlock);
        InputGuard guard;
        guard.pass(in, count, block_.data());
        oversampling_.up(block_.data(), count, fine_.data());
        for (std::size_t k = 0; k < count; ++k) {
            share_ += smoothing_ * (shareTarget_ - share_);
            faulty_ = guard.faultAt[k];
            for (std::size_t s = 0; s < factor; ++s) {
                if (!faulty_)
                    fine_[k * factor + s] = advance(fine_[k * factor + s]);
                if (faulty_) {
                    rest();
                    fine_[k * factor + s] = 0.0;
                    guard.faultAt[k] = true;
                }
            }
        }
        oversampling_.down(fine_.data(), count, block_.data());
        for (std::size_t k = 0; k < count; ++k) {
            if (guard.faultAt[k]) {
                recovery_.fault();
                faults_.fetch_add(1, std::memory_order_relaxed);
            }
            out[k] = withoutSubnormals(recovery_.step() * block_[k]);
        }
        in += count;
        out += count;
        n -= count;
    }
    displacement_.raise(peakDisplacement_);
    current_.raise(peakCurrent_);
    peakDisplacement_ = peakCurrent_ = 0.0;
}

Speaker::Meters Speaker::take() { return {displacement_.take(), current_.take(), faults_.load(std::memory_order_relaxed)}; }

double plateau(const Model& model)
{
    const double m = model.baseParameter("m").value;
    return model.electrical() ? model.baseParameter("Bl").value / (model.baseParameter("Re").value * m) : 1.0 / m;
}

} // namespace excursion
