// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/Protection.h"

#include "Engine/Predistortion/Foresight.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace excursion {
namespace {

// of the resonance: above the first one moves a cone little
constexpr double firstCorner = 2.5, secondCorner = 12.0;
// of the limit; the rest is for points between those that are looked at
constexpr double wishShare = 0.96, planShare = 0.992;
constexpr double limitTime = 0.008, powerLimitTime = 0.05;  // s, see Glide
// s, in which a signal follows a limit that falls before it is made to
constexpr double patience = 0.08;
// Spacings of what is looked at: in samples, and in periods of the resonance, so that no peak falls between
constexpr int planSamples = 4, wishSamples = 8;
constexpr double stepPeriods = 0.02;
// periods of the resonance: within a longer tick the cone does what its last look did not see
constexpr double shortTick = 0.05;
constexpr double farFromLimit = 0.7;                         // of the limit: more than a look can miss
constexpr double wishHoldTime = 0.1, wishReleaseTime = 0.3;  // s
constexpr double settlingTime = 0.5;                         // s, in which a driver forgets
constexpr double mostRange = 0.9;                            // of the limit, that a shift may take
constexpr double muteTime = 0.02, muteReleaseTime = 0.05;    // s

double reciprocal(double limit) { return std::isfinite(limit) ? 1.0 / limit : 0.0; }

/// The largest half, quarter, ... of so many samples that is no longer than this many periods; at least one.
int spacing(int samples, double periods, double f0, double rate)
{
    while (samples > 1 && samples * f0 > periods * rate)
        samples /= 2;
    return samples;
}

/// What a margin leaves of the limit.
double leftBy(double uncertainty, double margin) { return std::exp(-uncertainty * margin); }

int roundedUp(double samples, int step) { return static_cast<int>(std::ceil(samples / step)) * step; }

}  // namespace

Protection::Protection(const LinearMotion& motion, const RealTimeOptions& options, double delay,
                       const Eigen::MatrixXd& basis)
    : rate_(options.sampleRate),
      settled_(ticks::in(std::max(settlingTime, options.coupling.forgetting()), rate_)),
      planStep_(spacing(planSamples, stepPeriods, motion.resonance, rate_)),
      wishStep_(spacing(wishSamples, stepPeriods, motion.resonance, rate_)),
      looksEvery_(std::max(1, spacing(tick, LookTimes::spacing, motion.resonance, rate_) / wishStep_)),
      trusts_(tick * motion.resonance <= shortTick * rate_),
      committed_(roundedUp(delay - 0.5, planStep_)),
      known_(roundedUp(committed_ + latency, planStep_)),
      times_(motion, rate_, known_, planStep_),
      split_(firstCorner * motion.resonance, secondCorner * motion.resonance, rate_),
      wish_ {Reference(motion, rate_ / wishStep_), Reference(motion, rate_ / wishStep_),
             Reference(motion, rate_ / wishStep_)},
      shift_(motion, wishStep_ / rate_, tick / rate_, times_.coasting, times_.plan),
      uncertainty_(motion.uncertainty),
      sent_(static_cast<std::size_t>(committed_), 0.0),
      displacement_(limitTime, rate_ / tick),
      voltage_(limitTime, rate_ / tick),
      power_(powerLimitTime, rate_ / tick),
      past_(static_cast<std::size_t>(ticks::in(patience, rate_))),
      wishHold_ {PeakHold(ticks::in(wishHoldTime, rate_)), PeakHold(ticks::in(wishHoldTime, rate_)),
                 PeakHold(ticks::in(wishHoldTime, rate_))},
      reachHold_(ticks::in(wishHoldTime, rate_)),
      held_ {Factor(wishReleaseTime, rate_), Factor(wishReleaseTime, rate_), Factor(wishReleaseTime, rate_)},
      loud_(rate_),
      cool_(motion, rate_),
      heated_(motion.ohms > 0.0)
{
    const Foresight wish(motion, wish_.front().basis(), times_.coasting, 0, 1.0, 0.0);
    Foresight plan(motion, basis.size() > 0 ? basis : wish_.front().basis(), times_.plan, known_ / planStep_,
                   planStep_ / rate_, (committed_ - delay + 0.5) / rate_);
    plan.sharpen();
    byWish_ = LaidRows(wish.coasting);
    byCone_ = LaidRows(plan.coasting);
    byInput_ = LaidRows(plan.driven);
    std::array<double, window> weight {};
    double sum = 0.0;
    for (int k = 0; k < window; ++k)
        sum += weight[static_cast<std::size_t>(k)] = std::pow(std::sin(std::numbers::pi * (k + 0.5) / window), 4.0);
    for (int k = 0; k < window; ++k)
        for (int j = 0; j < tick; ++j)
            shape_[static_cast<std::size_t>(k + j)] += weight[static_cast<std::size_t>(k)] / sum;
    constexpr auto parts = static_cast<Eigen::Index>(bands);
    future_.resize(times_.plan.size());
    rest_.resize(times_.plan.size());
    drives_.resize(plan.driven.cols(), 1 + parts);
    driven_.resize(times_.plan.size(), 1 + parts);
    parts_.resize(times_.plan.size(), parts);
    state_.resize(wish.coasting.cols());
    coasted_.resize(times_.coasting.size());
    aside_.resize(times_.coasting.size());
    wishes_.resize(times_.coasting.size(), parts);
    reset();
}

void Protection::reset()
{
    split_.reset();
    for (auto& wish : wish_)
        wish.reset();
    shift_.reset();
    for (auto& delayed : delayed_)
        delayed.fill(0.0);
    std::fill(sent_.begin(), sent_.end(), 0.0);
    sum_.fill(0.0);
    oldest_ = sentAt_ = 0;
    summed_ = stepped_ = place_ = muteFor_ = 0;
    share_ = reach_ = offset_ = reserve_ = coasts_ = 0.0;
    need_.fill(1.0);
    undiminished_ = untouched_ = settled_;
    for (auto& gain : gain_) {  // as after factors of 1
        gain.fill(0.0);
        for (std::size_t k = 0; k < gain.size(); ++k)
            for (std::size_t later = k + tick; later < gain.size(); later += tick)
                gain[k] += shape_[later];
    }
    for (auto* limit : {&displacement_, &voltage_, &power_})
        limit->jump();
    std::fill(past_.begin(), past_.end(), Limits {displacement_.value(), voltage_.value()});
    for (auto* hold : {&wishHold_[0], &wishHold_[1], &wishHold_[2], &reachHold_})
        hold->reset();
    for (auto& held : held_)
        held.reset();
    loud_.reset();
    cool_.reset();
    mute_ = most_ = 1.0;
    factors_ = {};
}

double Protection::share(const LinearMotion& motion, double margin) { return leftBy(motion.uncertainty, margin); }

void Protection::set(const PredistortionControls& controls, bool on)
{
    // What is switched on holds at once, for all that comes from now on.
    const bool fresh = on && !on_;
    on_ = on;
    displacement_.aim(on ? reciprocal(controls.displacementLimit) / leftBy(uncertainty_, controls.margin) : 0.0);
    voltage_.aim(on ? reciprocal(controls.voltageLimit) : 0.0);
    power_.aim(on && heated_ ? reciprocal(controls.powerLimit) / powerShare(controls.margin) : 0.0);
    if (fresh) {
        for (auto* limit : {&displacement_, &voltage_, &power_})
            limit->jump();
        std::fill(past_.begin(), past_.end(), Limits {displacement_.value(), voltage_.value()});
        for (auto& wish : wish_)
            wish.reset();
        shift_.reset();
        sum_.fill(0.0);
        need_.fill(1.0);
        summed_ = place_ % wishStep_;  // steps end with the tick
        stepped_ = place_ / wishStep_ % looksEvery_;
        cool_.lead();
        coasts_ = 0.0;
        undiminished_ = 0;  // the cone may still move, of which the wish knows nothing
    }
}

/// Of each band, what a cone that moved as the wish asks, and were then left alone, would ask for.
void Protection::look()
{
    stepped_ = 0;
    const double limit = displacement_.value();
    if (!(limit > 0.0 || power_.value() > 0.0))
        return;
    state_ = wish_[0].state() + wish_[1].state() + wish_[2].state();
    byWish_.multiply(state_.data(), coasted_.data());
    aside_.setConstant(offset_);
    shift_.addTo(aside_, byWish_);
    const double farthest = (coasted_ + aside_).cwiseAbs().maxCoeff() + reserve_;
    coasts_ = std::max(coasts_, farthest);
    if (farthest * limit > wishShare) {
        constexpr auto last = static_cast<Eigen::Index>(bands) - 1;
        for (Eigen::Index b = 0; b < last; ++b) {
            byWish_.multiply(wish_[static_cast<std::size_t>(b)].state().data(), wishes_.col(b).data());
            coasted_ -= wishes_.col(b);
        }
        wishes_.col(last) = coasted_;
        const auto need = largestWithin(aside_, wishes_, {1.0, 1.0, 1.0}, std::max(0.0, wishShare / limit - reserve_));
        for (std::size_t b = 0; b < bands; ++b)
            need_[b] = std::min(need_[b], need[b]);
    }
}

/// The factors for what was looked at in this tick.
Protection::Values Protection::forWish()
{
    look();
    const double limit = displacement_.value();
    if (limit > 0.0 || power_.value() > 0.0)
        reach_ = reachHold_.step(coasts_ * limit);
    farthest_ = limit > 0.0 ? std::min(coasts_, wishShare / limit) : coasts_;
    factors_.displacement = wishShare / std::max(wishShare, coasts_ * limit);
    Values factors {};
    for (std::size_t b = 0; b < bands; ++b)
        factors[b] = held_[b].step(1.0 - wishHold_[b].step(1.0 - need_[b]), displacement_.value() != displacementNow_);
    need_.fill(1.0);
    coasts_ = 0.0;
    return factors;
}

/// Turns the factors down until a cone that gets them for a tick, and silence then, stays within its limit.
void Protection::plan(const Eigen::Map<const Eigen::VectorXd>& cone, bool astray, Values& factors)
{
    const double limit = displacementNow_;
    share_ = 0.0;
    // As long as nothing is turned down the cone is where the wish was, and what it will do has been looked at there.
    const bool undiminished = std::all_of(factors.begin(), factors.end(), [](double factor) { return factor == 1.0; });
    undiminished_ = undiminished && !astray ? std::min(undiminished_ + 1, settled_) : 0;
    if (!(limit > 0.0))
        return;
    if (undiminished_ == settled_ && (trusts_ || reach_ < farFromLimit)) {
        share_ = reach_;
        return;
    }
    // What is decided comes first, then what the factors of this tick act on, band by band.
    drives_.setZero();
    for (std::size_t k = 0; k < sent_.size(); ++k)
        drives_(static_cast<Eigen::Index>(k / planStep_), 0) += sent_[(sentAt_ + k) % sent_.size()] / planStep_;
    for (std::size_t k = 0, from = oldest_; k < latency; ++k, from = from + 1 == latency ? 0 : from + 1) {
        const auto step = static_cast<Eigen::Index>((sent_.size() + k) / planStep_);
        for (std::size_t b = 0; b < bands; ++b) {
            const double u = delayed_[b][from] / planStep_;
            drives_(step, 0) += u * gain_[b][k];
            drives_(step, static_cast<Eigen::Index>(b) + 1) += u * shape_[k];
        }
    }
    static_assert(1 + bands == 4);
    byInput_.multiplyFour(drives_.data(), driven_.data());
    byCone_.multiply(cone.data(), rest_.data());
    rest_ += driven_.col(0);
    rest_.array() += offset_;
    parts_ = driven_.rightCols<bands>();
    future_ = rest_;
    for (std::size_t b = 0; b < bands; ++b)
        future_ += factors[b] * parts_.col(static_cast<Eigen::Index>(b));
    if (shift_.happens()) {
        shift_.foresee(std::min(future_.cwiseAbs().maxCoeff(), 1.0 / limit));
        rest_ += shift_.middle();
        future_ += shift_.middle();
        share_ = ((future_.cwiseAbs() + shift_.range()).maxCoeff() + reserve_) * limit;
    } else {
        share_ = (future_.cwiseAbs().maxCoeff() + reserve_) * limit;
    }
    if (share_ > planShare) {
        const double room = std::max(0.0, planShare / limit - reserve_);
        if (shift_.happens() && room > 0.0)
            for (Eigen::Index i = 0; i < rest_.size(); ++i) {  // in a smaller room: the same as farther out
                const double farther = room / (room - std::min(shift_.range()[i], mostRange * room));
                rest_[i] *= farther;
                parts_.row(i) *= farther;
            }
        factors = largestWithin(rest_, parts_, factors, room);
    }
}

void Protection::decide(const Eigen::Map<const Eigen::VectorXd>& cone, const Outcome& last)
{
    for (auto* limit : {&displacement_, &voltage_, &power_})
        limit->step();
    // A limit that falls is first followed by what is to come, then asked of what comes out.
    past_[pastAt_] = {displacement_.value(), voltage_.value()};
    pastAt_ = pastAt_ + 1 == past_.size() ? 0 : pastAt_ + 1;
    displacementNow_ = std::min(displacement_.value(), past_[pastAt_].displacement);
    const double voltage = std::min(voltage_.value(), past_[pastAt_].voltage);
    voltageNow_ = voltage > 0.0 ? 1.0 / voltage : std::numeric_limits<double>::infinity();
    if (muteFor_ > 0) {
        --muteFor_;
        mute_ = 0.0;
    } else {
        mute_ = std::min(1.0, mute_ + tick / (muteReleaseTime * rate_));
    }

    factors_ = {};
    offset_ = last.offset;
    reserve_ = last.reserve;
    most_ = last.most;
    shift_.tell(last.correction);
    auto factors = forWish();
    factors_.voltage = loud_.decide(voltage_.value(), voltage_.value() != voltage, last.asked, last.wanted);
    factors_.power = cool_.decide(power_.value(), !power_.still(), last.heat, last.hotter, loud_.peak(), farthest_);
    for (auto& factor : factors)
        factor *= factors_.voltage * factors_.power * mute_ * most_;
    plan(cone, last.astray, factors);
    if (share_ > planShare)
        factors_.displacement = std::min(factors_.displacement, planShare / share_);
    const bool untouched = std::all_of(factors.begin(), factors.end(), [](double factor) { return factor == 1.0; });
    untouched_ = untouched ? std::min(untouched_ + 1, settled_) : 0;
    for (std::size_t b = 0; b < bands; ++b)
        for (std::size_t k = 0; k < gain_[b].size(); ++k)
            gain_[b][k] += factors[b] * shape_[k];
}

/// A sample of what is asked for.
void Protection::wish(const Values& values)
{
    for (std::size_t b = 0; b < bands; ++b)
        sum_[b] += values[b];
    if (++summed_ < wishStep_)
        return;
    for (std::size_t b = 0; b < bands; ++b)
        wish_[b].step(most_ * sum_[b] / wishStep_);
    shift_.step();
    sum_.fill(0.0);
    summed_ = 0;
    // At the end of a tick it is looked at in any case.
    if (++stepped_ >= looksEvery_ && place_ + 1 < tick)
        look();
}

double Protection::step(double u, bool sound)
{
    const auto values = split_.split(sound ? u : 0.0);
    if (!sound)
        muteFor_ = latency / tick + ticks::in(muteTime, rate_);
    double left = 0.0, out = 0.0;
    for (std::size_t b = 0; b < bands; ++b) {
        left += held_[b].value() * values[b];
        out += gain_[b][static_cast<std::size_t>(place_)] * std::exchange(delayed_[b][oldest_], values[b]);
    }
    oldest_ = oldest_ + 1 == latency ? 0 : oldest_ + 1;
    left *= most_;
    loud_.add(left);
    cool_.add(loud_.factor() * left);
    if (on_)
        wish(values);
    if (!sent_.empty()) {
        sent_[sentAt_] = out;
        sentAt_ = sentAt_ + 1 == sent_.size() ? 0 : sentAt_ + 1;
    }
    if (++place_ == tick) {
        place_ = 0;
        for (auto& gain : gain_) {
            std::copy(gain.begin() + tick, gain.end(), gain.begin());
            std::fill(gain.end() - tick, gain.end(), 0.0);
        }
    }
    return out;
}

}  // namespace excursion
