// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linearization/Predistorter.h"

#include "Engine/Linearization/InputGuard.h"
#include "Engine/Linearization/SoftLimit.h"
#include "Engine/Linearization/Subnormals.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

constexpr double controlTime = 0.005;     // s, time constant of the controls
constexpr double declickTime = 0.002;    // s

double reciprocal(double limit) { return std::isfinite(limit) ? 1.0 / limit : 0.0; }

} // namespace

Predistorter::Predistorter(const Model& model, const RealTimeOptions& options, const LinearizationControls& controls)
    : oversampling_((requireRunnable(model, options), options.oversampling)),
      reference_(model, options.sampleRate * options.oversampling), inverse_(model, options.sampleRate * options.oversampling),
      recovery_(2 * oversampling_.latency() + static_cast<int>(0.02 * options.sampleRate), static_cast<int>(0.05 * options.sampleRate)),
      smoothing_(1.0 - std::exp(-1.0 / (controlTime * options.sampleRate))), release_(std::exp(-1.0 / (declickTime * options.sampleRate))),
      dry_(static_cast<std::size_t>(oversampling_.latency()), 0.0)
{
    target_ = {1.0, 0.0, 0.0};
    set(controls);
    reset();
}

void Predistorter::reset()
{
    oversampling_.reset();
    reference_.reset();
    inverse_.reset();
    recovery_.reset();
    now_ = target_;
    std::fill(dry_.begin(), dry_.end(), 0.0);
    dryPlace_ = 0;
    lastOut_ = step_ = 0.0;
    faulty_ = false;
}

void Predistorter::set(const LinearizationControls& controls)
{
    if (!(controls.amount >= 0.0 && controls.amount <= 1.0 && controls.displacementLimit > 0.0 && controls.voltageLimit > 0.0))
        return;
    target_ = {controls.amount, reciprocal(controls.displacementLimit), reciprocal(controls.voltageLimit)};
}

/// One sample of the higher rate.
double Predistorter::advance(double u)
{
    auto motion = reference_.step(u);
    const double asked = std::abs(motion.x), share = asked * now_.displacement;
    softlimit::apply(motion, now_.displacement);
    const double bent = inverse_.step(motion);
    if (!(std::abs(bent) < InputGuard::loudest && asked < InputGuard::loudest)) {
        faulty_ = true;
        return 0.0;
    }
    double amount = now_.amount;
    if (constexpr double near = 0.75 * softlimit::knee; share > near) {
        const double s = std::min((share - near) / (softlimit::knee - near), 1.0);
        amount += (1.0 - amount) * s * s * (3.0 - 2.0 * s);
    }
    const double wanted = u + amount * (bent - u), out = softlimit::apply(wanted, now_.voltage);
    peak_.displacement = std::max(peak_.displacement, std::abs(motion.x));
    if (asked > std::abs(motion.x))
        peak_.displacementReduction = std::max(peak_.displacementReduction, 20.0 * std::log10(asked / std::abs(motion.x)));
    if (std::abs(wanted) > std::abs(out))
        peak_.voltageReduction = std::max(peak_.voltageReduction, 20.0 * std::log10(wanted / out));
    return out;
}

void Predistorter::fault()
{
    faulty_ = false;
    reference_.reset();
    inverse_.reset();
    faults_.fetch_add(1, std::memory_order_relaxed);
}

void Predistorter::process(const double* in, double* out, std::size_t n)
{
    const FlushSubnormals flush;
    const auto factor = static_cast<std::size_t>(oversampling_.factor());
    while (n > 0) {
        const std::size_t count = std::min(n, Oversampling::longestBlock);
        InputGuard guard;
        guard.pass(in, count, block_.data());
        oversampling_.up(block_.data(), count, fine_.data());
        std::array<Levels, Oversampling::longestBlock> levels;
        for (std::size_t k = 0; k < count; ++k) {
            now_.amount += smoothing_ * (target_.amount - now_.amount);
            now_.displacement += smoothing_ * (target_.displacement - now_.displacement);
            now_.voltage += smoothing_ * (target_.voltage - now_.voltage);
            levels[k] = now_;
            if (guard.faultAt[k])
                fault();
            for (std::size_t s = 0; s < factor; ++s) {
                auto& sample = fine_[k * factor + s];
                sample = advance(sample);
                if (faulty_) {
                    fault();
                    guard.faultAt[k] = true;
                }
            }
        }
        // The signal as it is, delayed.
        std::array<double, Oversampling::longestBlock> plain;
        for (std::size_t k = 0; k < count; ++k) {
            plain[k] = block_[k];
            if (!dry_.empty()) {
                std::swap(plain[k], dry_[dryPlace_]);
                dryPlace_ = dryPlace_ + 1 == dry_.size() ? 0 : dryPlace_ + 1;
            }
        }
        oversampling_.down(fine_.data(), count, block_.data());
        for (std::size_t k = 0; k < count; ++k) {
            if (guard.faultAt[k])
                recovery_.fault();
            const double weight = recovery_.step();
            double mixed = block_[k];
            if (weight < 1.0)
                mixed = weight * mixed + (1.0 - weight) * softlimit::apply(plain[k], levels[k].voltage);
            if (guard.faultAt[k])
                step_ = lastOut_ - mixed;
            mixed += step_;
            step_ *= release_;
            if (levels[k].voltage > 0.0)   // the filter on the way down may overshoot
                mixed = std::clamp(mixed, -1.0 / levels[k].voltage, 1.0 / levels[k].voltage);
            lastOut_ = mixed;
            peak_.voltage = std::max(peak_.voltage, std::abs(mixed));
            out[k] = withoutSubnormals(mixed);
        }
        in += count;
        out += count;
        n -= count;
    }
    publish();
}

void Predistorter::publish()
{
    displacement_.raise(peak_.displacement);
    voltage_.raise(peak_.voltage);
    power_.raise(peak_.power);
    displacementReduction_.raise(peak_.displacementReduction);
    voltageReduction_.raise(peak_.voltageReduction);
    powerReduction_.raise(peak_.powerReduction);
    peak_ = {};
}

Predistorter::Meters Predistorter::take()
{
    return {displacement_.take(), voltage_.take(), power_.take(), displacementReduction_.take(), voltageReduction_.take(), powerReduction_.take(),
            faults_.load(std::memory_order_relaxed)};
}

} // namespace excursion
