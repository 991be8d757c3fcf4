// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/Predistorter.h"

#include "Engine/Predistortion/DriverMotion.h"
#include "Engine/Predistortion/Subnormals.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {
namespace {

constexpr double amountTime = 0.005, nearTime = 0.0005;  // s, see Glide
constexpr double declickTime = 0.002;                    // s
constexpr double restTime = 0.05, returnTime = 0.05;     // s, after a fault
constexpr double nearFrom = 0.6, nearTo = 0.8;           // of the limit of the excursion

double smooth(double s) { return s * s * (3.0 - 2.0 * s); }

/// The state of the motion behind an amplifier per state of a Linearizer; empty without an amplifier.
Eigen::MatrixXd basisBehind(const Model& model, const RealTimeOptions& options)
{
    if (options.coupling.passesConstant())
        return {};
    const auto driver = Reference(model, options.sampleRate).basis();
    const auto n = driver.rows(), more = Eigen::Index {options.coupling.order};
    Eigen::MatrixXd basis = Eigen::MatrixXd::Identity(n + more, n + more);
    basis.topLeftCorner(n, n) = driver;
    return basis;
}

double decibelsDown(double factor) { return factor < 1.0 ? -20.0 * std::log10(std::max(factor, 1e-5)) : 0.0; }

}  // namespace

Predistorter::Predistorter(const Model& model, const RealTimeOptions& options, const PredistortionControls& controls)
    : oversampling_((requireRunnable(model, options), options.oversampling)),
      target_(OwnLinearPart(model), options.sampleRate),
      protection_(linearMotion(undonePart(model), options.sampleRate, options.coupling), options,
                  0.5 * oversampling_.latency() + 1.0 / options.oversampling, basisBehind(undonePart(model), options)),
      linearizer_(undonePart(model), options.sampleRate * options.oversampling, options.coupling),
      plausible_(model),
      recovery_(static_cast<int>(restTime * options.sampleRate), static_cast<int>(returnTime * options.sampleRate)),
      plain_(undonePart(model), options.sampleRate),
      ohms_(model.electrical() ? model.baseParameter("Re").value : 0.0),
      period_(1.0 / options.sampleRate),
      amount_(amountTime, options.sampleRate),
      near_(nearTime, options.sampleRate),
      effort_(nearTime, options.sampleRate, 1.0),
      decay_(std::exp(-1.0 / (declickTime * options.sampleRate * options.oversampling)))
{
    set(controls);
    reset();
}

double Predistorter::share(const Model& model, double margin)
{
    const RealTimeOptions anyRate;  // the share is the same at all of them
    requireRunnable(model, anyRate);
    return Protection::share(linearMotion(undonePart(model), anyRate.sampleRate), margin);
}

void Predistorter::reset()
{
    oversampling_.reset();
    target_.reset();
    protection_.reset();
    linearizer_.reset();
    plain_.reset();
    recovery_.reset();
    amount_.jump();
    near_.jump(0.0);
    effort_.jump(1.0);
    outcome_ = {};
    correction_ = squares_ = last_ = left_ = betweenPeak_ = 0.0;
}

void Predistorter::set(const PredistortionControls& controls)
{
    if (controls.areSound())
        controls_ = controls;
    turn(on_);
}

void Predistorter::turn(bool on)
{
    if (on && !bends())
        linearizer_.rest();
    on_ = on;
    target_.aim(on ? controls_.target : Target {});
    amount_.aim(on ? controls_.amount : 0.0);
    protection_.set(controls_, on);
}

Warmth Predistorter::warmth() const
{
    Warmth warmth;
    linearizer_.keep(warmth);
    warmth.heat = protection_.heat();
    return warmth;
}

void Predistorter::warm(const Warmth& warmth)
{
    linearizer_.warm(warmth);
    protection_.warm(warmth.heat);
}

/// The coil's current is taken for that of the linear driver.
/// @returns sum of the squares of the current, A^2
double Predistorter::heatBy(const double* volts, std::size_t n)
{
    double squares = 0.0;
    if (!(ohms_ > 0.0))
        return squares;
    for (std::size_t k = 0; k < n; ++k) {
        const auto& motion = plain_.step(sound(volts[k]));
        linearizer_.drift(motion, period_);
        squares += motion.i * motion.i;
    }
    return squares;
}

void Predistorter::pass(const double* volts, std::size_t n)
{
    const FlushSubnormals flush;
    const auto samples = static_cast<double>(n);
    for (std::size_t k = 0; k < n; ++k)
        for (int s = 0; s < oversampling_.factor(); ++s)
            linearizer_.pass(sound(volts[k]));
    if (n > 0)
        protection_.rest((ohms_ + linearizer_.rise()) * heatBy(volts, n) / samples, samples);
}

/// One sample of the higher rate.
void Predistorter::bend(double& sample, double amount)
{
    const double asked = sample;
    outcome_.astray = outcome_.astray || amount < 1.0;
    double out = linearizer_.step(asked, amount,
                                  on_ ? protection_.voltageLimit() : std::numeric_limits<double>::infinity());
    const auto& motion = linearizer_.cone().motion();
    const double x = std::abs(motion.x), i = linearizer_.current();
    if (!(std::abs(out) < plausible_.input() && std::abs(linearizer_.wanted()) < plausible_.input()
          && plausible_.holds(i, x, motion.v))) {
        fault();
        out = 0.0;
    } else {
        peak_.displacement = std::max(peak_.displacement, x);
        outcome_.asked = std::max(outcome_.asked, std::abs(asked));
        outcome_.astray = outcome_.astray || out != linearizer_.wanted();
        outcome_.wanted = std::max(outcome_.wanted, std::abs(linearizer_.wanted()));
        squares_ += i * i;
        correction_ += out - asked;
    }
    sample = last_ = out + left_;
    linearizer_.pass(sample);
    left_ *= decay_;
}

void Predistorter::fault()
{
    // An amplifier cannot lose its charge; what is known of the coil may be what went wrong.
    Warmth kept;
    linearizer_.keep(kept);
    linearizer_.reset();
    linearizer_.warm({.charge = kept.charge});
    recovery_.fault();
    left_ = last_;
    faults_.fetch_add(1, std::memory_order_relaxed);
}

void Predistorter::begin(const double* in, std::size_t n)
{
    const FlushSubnormals flush;
    const auto factor = static_cast<std::size_t>(oversampling_.factor());
    if (protection_.due()) {
        outcome_.hotter = ohms_ > 0.0 ? 1.0 + linearizer_.rise() / ohms_ : 1.0;
        outcome_.heat = ohms_ * outcome_.hotter * squares_ / static_cast<double>(Protection::tick * factor);
        outcome_.correction = correction_ / static_cast<double>(Protection::tick * factor);
        protection_.decide(linearizer_.state(), outcome_);
        outcome_ = {};
        correction_ = squares_ = 0.0;
        const auto& factors = protection_.factors();
        least_ = {std::min(least_.displacement, factors.displacement), std::min(least_.voltage, factors.voltage),
                  std::min(least_.power, factors.power)};
        const double share = std::clamp((protection_.share() - nearFrom) / (nearTo - nearFrom), 0.0, 1.0);
        near_.aim(smooth(share));
        effort_.aim(protection_.effort());
    }
    for (std::size_t k = 0; k < n; ++k) {
        const bool holds = std::abs(in[k]) < plausible_.input();  // not for NaN
        if (!holds)
            faults_.fetch_add(1, std::memory_order_relaxed);
        block_[k] = recovery_.step() * protection_.step(target_.step(sound(in[k])), holds);
    }
    if (!bends())
        squares_ += static_cast<double>(factor) * heatBy(block_.data(), n);
    oversampling_.up(block_.data(), n, between_.data());
    for (std::size_t k = 0; k < n; ++k) {
        const double amount = amount_.step(), near = near_.step(), effort = effort_.step();
        if (bends())
            for (std::size_t s = 0; s < factor; ++s)
                bend(between_[k * factor + s], on_ ? effort * (amount + (1.0 - amount) * near) : amount);
        else
            for (std::size_t s = 0; s < factor; ++s)
                linearizer_.pass(between_[k * factor + s]);
    }
    betweenPeak_ = 0.0;
    for (std::size_t k = 0; k < n * factor; ++k)
        betweenPeak_ = std::max(betweenPeak_, std::abs(between_[k]));
}

void Predistorter::finish(double* out, std::size_t n, bool voltage)
{
    const FlushSubnormals flush;
    oversampling_.down(between_.data(), n, out);
    // The filter on the way down may overshoot.
    const double limit = on_ && voltage ? protection_.voltageLimit() : std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < n; ++k) {
        out[k] = withoutSubnormals(std::clamp(out[k], -limit, limit));
        if (voltage)
            peak_.voltage = std::max(peak_.voltage, std::abs(out[k]));
    }
    if (!voltage)
        peak_.voltage = std::max(peak_.voltage, betweenPeak_);
}

void Predistorter::process(const double* in, double* out, std::size_t n)
{
    while (n > 0) {
        const std::size_t taken = std::min(n, room());
        begin(in, taken);
        finish(out, taken);
        in += taken;
        out += taken;
        n -= taken;
    }
    publish();
}

void Predistorter::publish()
{
    displacement_.raise(peak_.displacement);
    voltage_.raise(peak_.voltage);
    power_.raise(protection_.heat());
    displacementReduction_.raise(decibelsDown(least_.displacement));
    voltageReduction_.raise(decibelsDown(least_.voltage));
    powerReduction_.raise(decibelsDown(least_.power));
    least_ = {};
    peak_ = {};
}

Predistorter::Meters Predistorter::collectMeters()
{
    return {displacement_.readAndReset(),           voltage_.readAndReset(),          power_.readAndReset(),
            displacementReduction_.readAndReset(),  voltageReduction_.readAndReset(), powerReduction_.readAndReset(),
            faults_.load(std::memory_order_relaxed)};
}

}  // namespace excursion
