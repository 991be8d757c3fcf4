// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/DriverEngine.h"

#include <algorithm>
#include <cmath>

namespace excursion {

DriverEngine::DriverEngine(const Model& model, const RealTimeOptions& options, const PredistortionControls& controls)
    : bend_(model, options, controls),
      amplifier_(options.coupling, options.sampleRate * options.oversampling),
      cone_(model, options.sampleRate * options.oversampling),
      coneRecovery_(static_cast<int>(0.02 * options.sampleRate), static_cast<int>(0.05 * options.sampleRate)),
      perVolt_(1.0 / plateau(model)),
      factor_(options.oversampling)
{
}

void DriverEngine::reset()
{
    bend_.reset();
    amplifier_.reset();
    cone_.reset();
    coneRecovery_.reset();
}

void DriverEngine::resetBending()
{
    bend_.turn(false);
    bend_.reset();
    coneRecovery_.reset();
}

void DriverEngine::resetPlaying()
{
    const auto left = bend_.warmth();
    cone_.reset();
    cone_.warm(left);
    amplifier_.charge(left.charge);
}

void DriverEngine::warm(const Warmth& warmth)
{
    bend_.warm(warmth);
    cone_.warm(warmth);
    amplifier_.charge(warmth.charge);
}

/// The cone's part, at the higher rate.
void DriverEngine::play(std::size_t n, Fade& played)
{
    double* const samples = bend_.between();
    for (std::size_t k = 0; k < n; ++k) {
        const double weight = played.step(), volume = coneRecovery_.step();
        for (int s = 0; s < factor_; ++s) {
            double& u = samples[k * static_cast<std::size_t>(factor_) + static_cast<std::size_t>(s)];
            double a = amplifier_.pass(u);
            if (!cone_.step(a)) {
                coneRecovery_.fault();
                faults_.fetch_add(1, std::memory_order_relaxed);
            }
            u += weight * (volume * perVolt_ * a - u);
            peak_.displacement = std::max(peak_.displacement, std::abs(cone_.displacement()));
            peak_.current = std::max(peak_.current, std::abs(cone_.current()));
        }
    }
}

void DriverEngine::process(double* volts, std::size_t n, Fade& played)
{
    bend_.begin(volts, n);
    if (played.runs())
        play(n, played);
    bend_.finish(volts, n, !played.on());
}

void DriverEngine::publish()
{
    displacement_.raise(peak_.displacement);
    current_.raise(peak_.current);
    peak_ = {};
    bend_.publish();
}

ChainEngine::Meters DriverEngine::collectMeters()
{
    const auto bend = bend_.collectMeters();
    return {bend,
            {displacement_.readAndReset(), current_.readAndReset(), 0},
            0.0,
            bend.faults + faults_.load(std::memory_order_relaxed)};
}

}  // namespace excursion
