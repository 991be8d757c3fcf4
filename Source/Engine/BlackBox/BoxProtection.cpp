// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/BlackBox/BoxProtection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace excursion {
namespace {

constexpr double farBeyond = 100.0, beyondAll = 1e6;   // of the peak
constexpr double silenceTime = 0.05, riseTime = 0.05;  // s, after a fault
constexpr double apartTime = 0.2;                      // s
constexpr double nearFrom = 0.6, nearTo = 0.8;         // of the limit of the excursion
/// samples from the state of the cone to the next input
constexpr double coneDelay = 1.0;

/// The transform's error and what is always left of the distortion are never given away.
double sureShare(const BoxMotion& motion, double apartAfter)
{
    return 1.0 / ((1.0 + motion.error) * (1.0 + apartAfter));
}

double smooth(double s) { return s * s * (3.0 - 2.0 * s); }

}  // namespace

BoxProtection::BoxProtection(const BlackBox& box, const Region& region, const Rest& rest,
                             const BlackBoxRehearsal& rehearsal, double sampleRate, int late,
                             const AmplifierCoupling& coupling)
    : limiter_(box, region, sampleRate),
      motion_(box),
      protection_(behind(motion_.linear, coupling), {sampleRate, 1, coupling}, coneDelay),
      cone_(behind(motion_.linear, coupling), sampleRate),
      recovery_(static_cast<int>(silenceTime * sampleRate), static_cast<int>(riseTime * sampleRate)),
      apart_(static_cast<int>(apartTime * box.linear.sampleRate)),
      nearness_(late / Protection::tick + 2),
      offset_(motion_.offset.data(), motion_.offset.data() + motion_.offset.size()),
      rest_(rest.q.data(), rest.q.data() + rest.q.size()),
      moves_(tellsExcursion(box)),
      coil_(drivesCoil(box)),
      farBeyond_(farBeyond * box.stimulus.peak),
      beyondAll_(beyondAll * box.stimulus.peak),
      apartBefore_(rehearsal.apartBefore),
      apartAfter_(rehearsal.apartAfter),
      delayed_(static_cast<std::size_t>(limiter_.reach())),
      plain_(static_cast<std::size_t>(Protection::latency))
{
    reset();
}

void BoxProtection::reset()
{
    limiter_.reset();
    protection_.reset();
    cone_.reset();
    recovery_.reset();
    apart_.reset();
    nearness_.reset();
    faulty_ = decided_ = false;
    region_ = least_ = amount_ = 1.0;
    near_ = squares_ = 0.0;
    outcome_ = {};
    std::fill(delayed_.begin(), delayed_.end(), 0.0);
    std::fill(plain_.begin(), plain_.end(), 0.0);
    at_ = plainAt_ = 0;
}

double BoxProtection::share(const BlackBox& box, const BlackBoxRehearsal& rehearsal, double margin)
{
    const BoxMotion motion(box);
    return Protection::share(motion.linear, margin) * sureShare(motion, rehearsal.apartAfter);
}

void BoxProtection::set(const PredistortionControls& controls, bool on)
{
    on_ = on;
    ohms_ = coil_ ? controls.coilResistance : 0.0;
    auto limits = controls;
    if (!moves_)
        limits.margin = 0.0;  // it is of the excursion
    limits.displacementLimit = controls.displacementLimit * sureShare(motion_, apartAfter_);
    limits.powerLimit = ohms_ > 0.0 ? ohms_ * controls.powerLimit : std::numeric_limits<double>::infinity();
    limit_ = std::isfinite(limits.displacementLimit) ? limits.displacementLimit : 0.0;
    protection_.set(limits, on);
}

void BoxProtection::decide()
{
    outcome_.heat = squares_ / Protection::tick;
    outcome_.most = region_ = std::exchange(least_, 1.0);
    squares_ = 0.0;
    // What the rehearsal has seen is in the limit already.
    const double known = apartAfter_ * limit_, uncorrected = std::max(apartBefore_ - apartAfter_, 0.0) * limit_;
    outcome_.reserve = std::max(apart_.value() - known, 0.0) + (1.0 - amount_) * uncorrected;
    protection_.decide(cone_.state(), outcome_);
    // The offset stands until it is told anew.
    outcome_ = {.offset = outcome_.offset};
    const double share = nearness_.step(protection_.share());
    near_ = smooth(std::clamp((share - nearFrom) / (nearTo - nearFrom), 0.0, 1.0));
}

double BoxProtection::step(double sample)
{
    faulty_ = !sound(sample);
    sample = bounded(sample);
    if (faulty_) {
        recovery_.fault();
        sample = 0.0;
    }
    decided_ = protection_.due();
    if (decided_)
        decide();
    const double within = limiter_.step(sample);
    least_ = std::min(least_, recovery_.step() * (on_ ? within : 1.0));
    if (!delayed_.empty()) {
        std::swap(sample, delayed_[at_]);
        at_ = at_ + 1 == delayed_.size() ? 0 : at_ + 1;
    }
    double out = protection_.step(sample, true);
    std::swap(sample, plain_[plainAt_]);
    plainAt_ = plainAt_ + 1 == plain_.size() ? 0 : plainAt_ + 1;
    if (protection_.untouched())
        out = sample;  // what the bands sum up to, without their rounding
    cone_.step(out);
    return out;
}

void BoxProtection::note(const std::vector<double>& slow, double apart, double asked, double wanted)
{
    double offset = 0.0;
    for (std::size_t k = 0; k < offset_.size(); ++k)
        offset += offset_[k] * (slow[k] - rest_[k]);
    outcome_.offset = offset;
    apart_.step(std::abs(apart));
    outcome_.asked = std::max(outcome_.asked, std::abs(asked));
    outcome_.wanted = std::max(outcome_.wanted, std::abs(wanted));
}

void BoxProtection::pass(const double* volts, std::size_t n)
{
    double squares = 0.0;
    for (std::size_t k = 0; k < n; ++k)
        if (const double u = bounded(volts[k]); sound(volts[k]))
            squares += u * u;
    const auto samples = static_cast<double>(n);
    if (n > 0)
        protection_.rest(squares / samples, samples);
}

void BoxProtection::sent(double out, double amount)
{
    squares_ += out * out;
    amount_ = amount;
}

}  // namespace excursion
