// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/BlackBox/BlackBoxEngine.h"

#include <algorithm>
#include <cmath>

namespace excursion {

BlackBoxEngine::BlackBoxEngine(const PlayedBox& played, double sampleRate, const PredistortionControls& controls,
                               const AmplifierCoupling& coupling)
    : amplifier_(coupling, sampleRate),
      speaker_(played.box, played.region, played.rest, sampleRate),
      perOutput_(played.perOutput),
      moves_(tellsExcursion(played.box)),
      waiting_(static_cast<std::size_t>(speaker_.latency()))
{
    if (played.rehearsal)
        bend_.emplace(RehearsedBox(played.box, played.region, played.rest, *played.rehearsal), sampleRate,
                      PredistortionControls {}, coupling);
    set(controls);
    reset();
}

void BlackBoxEngine::reset()
{
    if (bend_)
        bend_->reset();
    amplifier_.reset();
    resetPlaying();
    std::fill(waiting_.begin(), waiting_.end(), 0.0);
    at_ = 0;
}

void BlackBoxEngine::resetBending()
{
    turn(false);
    if (bend_)
        bend_->reset();
    std::fill(waiting_.begin(), waiting_.end(), 0.0);
}

void BlackBoxEngine::resetPlaying()
{
    // an amplifier does not lose its charge as the loudspeaker behind it is played
    const auto left = warmth();
    amplifier_.charge(left.charge);
    speaker_.reset();
}

void BlackBoxEngine::warm(const Warmth& warmth)
{
    if (bend_)
        bend_->warm(warmth);
    amplifier_.charge(warmth.charge);
}

void BlackBoxEngine::pass(const double* volts, std::size_t n)
{
    if (bend_)
        bend_->pass(volts, n);
    else
        for (std::size_t k = 0; k < n; ++k)
            amplifier_.take(std::isfinite(volts[k]) ? volts[k] : 0.0);
}

void BlackBoxEngine::set(const PredistortionControls& controls)
{
    if (controls.areSound())
        voltageLimit_ = controls.voltageLimit;
    if (bend_)
        bend_->set(controls);
}

void BlackBoxEngine::turn(bool bends)
{
    on_ = bends;
    if (bend_)
        bend_->turn(bends);
}

void BlackBoxEngine::process(double* volts, std::size_t n, Fade& played)
{
    if (bend_)
        bend_->process(volts, volts, n);
    else
        for (std::size_t k = 0; k < n; ++k)
            if (!std::isfinite(volts[k])) {
                volts[k] = 0.0;
                faults_.fetch_add(1, std::memory_order_relaxed);
            } else if (on_) {
                volts[k] = std::clamp(volts[k], -voltageLimit_, voltageLimit_);
            }
    const bool plays = played.runs();
    if (plays) {
        for (std::size_t k = 0; k < n; ++k)
            sound_[k] = amplifier_.pass(volts[k]);
        speaker_.process(sound_.data(), sound_.data(), n);
    } else if (!bend_) {
        for (std::size_t k = 0; k < n; ++k)
            amplifier_.take(volts[k]);
    }
    for (std::size_t k = 0; k < n; ++k) {
        if (!waiting_.empty()) {
            std::swap(volts[k], waiting_[at_]);
            at_ = at_ + 1 == waiting_.size() ? 0 : at_ + 1;
        }
        if (plays)
            volts[k] += played.step() * (perOutput_ * sound_[k] - volts[k]);
    }
}

ChainEngine::Meters BlackBoxEngine::collectMeters()
{
    Meters meters;
    const auto speaker = speaker_.collectMeters();
    meters.region = speaker.region;
    if (moves_)
        meters.speaker.displacement = speaker.output;
    meters.faults = speaker.faults + faults_.load(std::memory_order_relaxed);
    if (bend_) {
        const auto bend = bend_->collectMeters();
        meters.predistorter = bend;
        // What keeps to where the fit was keeps the cone from going too far as well.
        meters.predistorter.displacementReduction += bend.regionReduction;
        meters.region = std::max(meters.region, bend.region);
        meters.faults += bend.faults;
    }
    return meters;
}

}  // namespace excursion
