// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/BlackBox/BlackBoxPredistorter.h"

#include "Engine/Predistortion/Subnormals.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

/// What a correction may be: more than the rehearsal's largest, as other phases add up otherwise, and what a tone of
/// the input's peak may ask for.
double largestCorrection(const RehearsedBox& model)
{
    constexpr double headroom = 1.5, ofPeak = 0.5;
    return std::max(headroom * model.rehearsal.correction, ofPeak * model.box.stimulus.peak);
}

constexpr double amountTime = 0.005;  // s, see Glide
constexpr double memoryTime = 0.1;    // s

}  // namespace

RehearsedBox::RehearsedBox(const BlackBox& wanted)
    : box(wanted), region(visitedBy(box)), rest(restOf(box)), rehearsal(rehearse(box, region, rest))
{
}

RehearsedBox::RehearsedBox(const BlackBox& known, const Region& where, const Rest& still,
                           const BlackBoxRehearsal& rehearsed)
    : box(known), region(where), rest(still), rehearsal(rehearsed)
{
}

BlackBoxPredistorter::BlackBoxPredistorter(const RehearsedBox& model, double sampleRate,
                                           const BlackBoxControls& controls)
    : limiter_(model.box, model.region, sampleRate),
      toModel_(sampleRate, model.box.linear.sampleRate),
      back_(model.box.linear.sampleRate, sampleRate),
      linearizer_(model.box, model.region, model.rest, model.rehearsal.design),
      bound_(model.box.stimulus.peak + largestCorrection(model)),
      largest_(largestCorrection(model)),
      // A correction of the time of input n is there when the model has heard its latency more, and both converters
      // what they reach ahead.
      behind_(toModel_.reach()
              + static_cast<int>(
                  std::ceil((linearizer_.latency() + back_.reach()) * sampleRate / model.box.linear.sampleRate))
              + (toModel_.reach() > 0 ? 2 : 0)),
      memory_(linearizer_.latency() + static_cast<int>(memoryTime * model.box.linear.sampleRate)),
      amount_(amountTime, sampleRate),
      delayed_(static_cast<std::size_t>(behind_) + 1),
      corrections_(static_cast<std::size_t>(behind_) + 64)
{
    set(controls);
    reset();
}

void BlackBoxPredistorter::reset()
{
    limiter_.reset();
    toModel_.reset();
    back_.reset();
    linearizer_.reset();
    // Switched off it stands still: what it will be switched on into is not silence, and it has to listen first.
    idle_ = !on_;
    warm_ = 0;
    set(controls_);
    amount_.jump();
    std::fill(delayed_.begin(), delayed_.end(), 0.0);
    std::fill(corrections_.begin(), corrections_.end(), 0.0);
    at_ = made_ = used_ = 0;
    early_ = behind_;
    // The model's samples are `latency` late: those that come first are of before the beginning, and belong to no
    // sample.
    skip_ = linearizer_.latency();
}

void BlackBoxPredistorter::set(const BlackBoxControls& controls)
{
    if (controls.areSound())
        controls_ = controls;
    amount_.aim(on_ && !idle_ && warm_ == 0 ? controls_.amount : 0.0);
}

void BlackBoxPredistorter::turn(bool on)
{
    on_ = on;
    set(controls_);
}

/// Of one sample at the model's rate; none while it stands still.
double BlackBoxPredistorter::correctionFor(double u, double limit, double& region)
{
    if (!on_ && amount_.still()) {
        idle_ = true;
        warm_ = 0;
        return 0.0;
    }
    if (idle_) {
        linearizer_.reset();
        idle_ = false;
        warm_ = memory_;
    }
    const auto sample = linearizer_.step(u, largest_, limit);
    region = std::max(region, sample.distance);
    if (warm_ > 0 && --warm_ == 0)
        set(controls_);
    return sample.correction;
}

void BlackBoxPredistorter::process(const double* in, double* out, std::size_t n)
{
    const FlushSubnormals flush;
    const double limit = std::min(bound_, controls_.inputLimit);
    double peak = 0.0, correction = 0.0, region = 0.0, least = 1.0;
    for (std::size_t k = 0; k < n; ++k) {
        const double u = limiter_.step(in[k], on_);
        least = std::min(least, limiter_.gain());
        if (limiter_.faulty())
            faults_.fetch_add(1, std::memory_order_relaxed);
        toModel_.push(u);
        for (double v = 0.0; toModel_.pull(v);) {
            const double made = correctionFor(v, limit, region);
            if (skip_ > 0) {
                --skip_;
                continue;
            }
            back_.push(made);
            for (double w = 0.0; back_.pull(w);) {
                corrections_[made_] = w;
                made_ = made_ + 1 == corrections_.size() ? 0 : made_ + 1;
            }
        }
        const double plain = delayed_[at_ + 1 == delayed_.size() ? 0 : at_ + 1];
        delayed_[at_] = u;
        at_ = at_ + 1 == delayed_.size() ? 0 : at_ + 1;
        double w = 0.0;
        if (early_ > 0) {
            --early_;
        } else {
            w = corrections_[used_];
            used_ = used_ + 1 == corrections_.size() ? 0 : used_ + 1;
        }
        w *= amount_.step();
        out[k] = withoutSubnormals(on_ ? std::clamp(plain + w, -limit, limit) : plain + w);
        peak = std::max(peak, std::abs(out[k]));
        correction = std::max(correction, std::abs(w));
    }
    out_.raise(peak);
    correction_.raise(correction);
    region_.raise(region);
    reduction_.raise(least < 1.0 ? -20.0 * std::log10(std::max(least, 1e-5)) : 0.0);
}

BlackBoxPredistorter::Meters BlackBoxPredistorter::collectMeters()
{
    return {out_.readAndReset(), correction_.readAndReset(), region_.readAndReset(), reduction_.readAndReset(),
            faults_.load(std::memory_order_relaxed)};
}

}  // namespace excursion
