// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/BlackBox/BlackBoxPredistorter.h"

#include "Engine/BlackBox/BoxLinearPart.h"
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

constexpr double amountTime = 0.005, nearTime = 0.0005;  // s, see Glide
constexpr double memoryTime = 0.1;                       // s

double decibelsDown(double factor) { return factor < 1.0 ? -20.0 * std::log10(std::max(factor, 1e-5)) : 0.0; }

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
                                           const PredistortionControls& controls, const AmplifierCoupling& coupling)
    : toModel_(sampleRate, model.box.linear.sampleRate, model.box.stimulus.highest()),
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
      target_(ownLinearPart(model.box), sampleRate),
      protection_(model.box, model.region, model.rest, model.rehearsal, sampleRate, behind_, coupling),
      truth_(model.box, model.region),
      signal_(coupling, sampleRate),
      added_(coupling, model.box.linear.sampleRate),
      x_(truth_.states()),
      z_(truth_.seen() + 1),
      q_(truth_.combinations()),
      rest_(model.rest),
      still_(model.box.linear.C.row(0).dot(rest_.x) + model.box.F.row(0).dot(rest_.q)),
      moves_(tellsExcursion(model.box)),
      memory_(linearizer_.latency() + static_cast<int>(memoryTime * model.box.linear.sampleRate)),
      gate_(amountTime, sampleRate),
      amount_(amountTime, sampleRate),
      near_(nearTime, sampleRate),
      effort_(nearTime, sampleRate, 1.0),
      delayed_(static_cast<std::size_t>(behind_) + 1),
      corrections_(static_cast<std::size_t>(behind_) + 64)
{
    set(controls);
    reset();
}

void BlackBoxPredistorter::reset()
{
    target_.reset();
    protection_.reset();
    signal_.reset();
    toModel_.reset();
    back_.reset();
    linearizer_.reset();
    standStill();
    // Switched off it stands still: what it will be switched on into is not silence, and it has to listen first.
    idle_ = !on_;
    warm_ = 0;
    set(controls_);
    gate_.jump();
    amount_.jump();
    near_.jump(0.0);
    effort_.jump(1.0);
    std::fill(delayed_.begin(), delayed_.end(), 0.0);
    std::fill(corrections_.begin(), corrections_.end(), 0.0);
    at_ = made_ = used_ = 0;
    early_ = behind_;
    // The model's samples are `latency` late: those that come first are of before the beginning, and belong to no
    // sample.
    skip_ = linearizer_.latency();
}

void BlackBoxPredistorter::standStill()
{
    std::fill(x_.begin(), x_.end(), 0.0);
    std::copy(rest_.x.begin(), rest_.x.end(), x_.begin());
    std::fill(q_.begin(), q_.end(), 0.0);
    std::copy(rest_.q.begin(), rest_.q.end(), q_.begin());
    added_.reset();
}

void BlackBoxPredistorter::warm(const Warmth& warmth)
{
    protection_.warm(warmth.heat);
    signal_.charge(warmth.charge);
}

void BlackBoxPredistorter::pass(const double* volts, std::size_t n)
{
    protection_.pass(volts, n);
    for (std::size_t k = 0; k < n; ++k)
        signal_.take(protection_.sound(volts[k]) ? protection_.bounded(volts[k]) : 0.0);
}

void BlackBoxPredistorter::set(const PredistortionControls& controls)
{
    if (controls.areSound())
        controls_ = controls;
    gate_.aim(on_ && !idle_ && warm_ == 0 ? 1.0 : 0.0);
    amount_.aim(controls_.amount);
    target_.aim(on_ ? controls_.target : Target {});
    protection_.set(controls_, on_);
}

void BlackBoxPredistorter::turn(bool on)
{
    on_ = on;
    set(controls_);
}

/// Of the correction, as it is at the moment.
double BlackBoxPredistorter::amountNow() const
{
    const double amount = amount_.value();
    return gate_.value() * effort_.value() * (amount + (1.0 - amount) * near_.value());
}

/// Where the model is that is given what comes out.
void BlackBoxPredistorter::follow(const BlackBoxLinearizer::Sample& sample, double limit)
{
    double apart = 0.0;
    if (moves_) {
        const double sum = sample.input + added_.pass(amountNow() * sample.correction),
                     u = on_ ? std::clamp(sum, -limit, limit) : sum;
        truth_.see(x_.data(), u, z_.data());
        truth_.combinationsAt(z_.data(), u, nullptr, q_.data());
        const double y = truth_.advance(x_.data(), u, q_.data());
        apart = y - (sample.output - sample.residual);
        peak_.displacement = std::max(peak_.displacement, std::abs(y - still_));
    }
    protection_.note(linearizer_.slow(), warm_ > 0 ? 0.0 : apart, std::abs(sample.input) + withheld_,
                     std::abs(sample.wanted) + withheld_);
}

/// Of one sample at the model's rate; none while it stands still.
double BlackBoxPredistorter::correctionFor(double u, double limit)
{
    if (!on_ && gate_.still()) {
        idle_ = true;
        warm_ = 0;
        return 0.0;
    }
    if (idle_) {
        linearizer_.reset();
        standStill();
        idle_ = false;
        warm_ = memory_;
    }
    const auto sample = linearizer_.step(u, largest_, limit);
    peak_.region = std::max(peak_.region, sample.distance);
    follow(sample, limit);
    if (warm_ > 0 && --warm_ == 0)
        set(controls_);
    return sample.correction;
}

void BlackBoxPredistorter::process(const double* in, double* out, std::size_t n)
{
    const FlushSubnormals flush;
    for (std::size_t k = 0; k < n; ++k) {
        const double u = protection_.step(protection_.sound(in[k]) ? target_.step(protection_.bounded(in[k])) : in[k]);
        if (protection_.faulty())
            faults_.fetch_add(1, std::memory_order_relaxed);
        near_.aim(protection_.near());
        effort_.aim(protection_.effort());
        const double limit = std::min(bound_, protection_.voltageLimit());
        const double passed = signal_.pass(u);
        withheld_ = std::abs(u - passed);
        toModel_.push(passed);
        for (double v = 0.0; toModel_.pull(v);) {
            const double made = correctionFor(v, limit + withheld_);
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
        for (auto* glide : {&gate_, &amount_, &near_, &effort_})
            glide->step();
        const double amount = amountNow();
        w *= amount;
        out[k] = withoutSubnormals(on_ ? std::clamp(plain + w, -limit, limit) : plain + w);
        protection_.sent(out[k], amount);
        look(out[k], w);
    }
    publish();
}

/// For the meters.
void BlackBoxPredistorter::look(double out, double correction)
{
    const auto reductions = protection_.reductions();
    peak_.voltage = std::max(peak_.voltage, std::abs(out));
    peak_.correction = std::max(peak_.correction, std::abs(correction));
    peak_.power = std::max(peak_.power, protection_.heat());
    const auto least = [](double& factor, double now) { factor = std::max(factor, decibelsDown(now)); };
    if (!protection_.decided())
        return;
    least(peak_.displacementReduction, reductions.factors.displacement);
    least(peak_.voltageReduction, reductions.factors.voltage);
    least(peak_.powerReduction, reductions.factors.power);
    least(peak_.regionReduction, reductions.region);
}

void BlackBoxPredistorter::publish()
{
    displacement_.raise(peak_.displacement);
    out_.raise(peak_.voltage);
    power_.raise(peak_.power);
    correction_.raise(peak_.correction);
    region_.raise(peak_.region);
    displacementReduction_.raise(peak_.displacementReduction);
    voltageReduction_.raise(peak_.voltageReduction);
    powerReduction_.raise(peak_.powerReduction);
    regionReduction_.raise(peak_.regionReduction);
    peak_ = {};
}

BlackBoxPredistorter::Meters BlackBoxPredistorter::collectMeters()
{
    Meters meters;
    meters.displacement = displacement_.readAndReset();
    meters.voltage = out_.readAndReset();
    meters.power = power_.readAndReset();
    meters.displacementReduction = displacementReduction_.readAndReset();
    meters.voltageReduction = voltageReduction_.readAndReset();
    meters.powerReduction = powerReduction_.readAndReset();
    meters.faults = faults_.load(std::memory_order_relaxed);
    meters.correction = correction_.readAndReset();
    meters.region = region_.readAndReset();
    meters.regionReduction = regionReduction_.readAndReset();
    return meters;
}

}  // namespace excursion
