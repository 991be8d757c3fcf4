// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/Chain.h"

#include "Engine/Predistortion/Subnormals.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

constexpr double fadeTime = 0.05;     // s, from mode to mode
constexpr double levelTime = 0.005;   // s, see Glide
constexpr double plainTime = 0.0003;  // s, see Glide: gone within the latency

}  // namespace

Chain::Chain(const Model& model, const RealTimeOptions& options, const ChainControls& controls)
    : bend_(model, options, controls.linearization),
      cone_(model, options.sampleRate * options.oversampling),
      coneRecovery_(static_cast<int>(0.02 * options.sampleRate), static_cast<int>(0.05 * options.sampleRate)),
      wet_(static_cast<int>(fadeTime * options.sampleRate), bend_.latency()),
      played_(static_cast<int>(fadeTime * options.sampleRate), 0),
      perVolt_(1.0 / plateau(model)),
      factor_(options.oversampling),
      fullScale_(levelTime, options.sampleRate),
      before_(levelTime, options.sampleRate),
      after_(levelTime, options.sampleRate),
      plainGain_(plainTime, options.sampleRate, 1.0),
      plain_(static_cast<std::size_t>(bend_.latency()))
{
    set(controls);
    reset();
}

void Chain::set(const ChainControls& controls)
{
    const auto mode = controls.mode;
    const bool bends = mode == Mode::linearize || mode == Mode::audition,
               plays = mode != Mode::bypass && mode != Mode::linearize;
    if (mode != Mode::bypass) {
        if (!wet_.runs()) {  // what is switched in finds nothing of before
            bend_.turn(false);
            bend_.reset();
            coneRecovery_.reset();
            played_.turn(plays);
            played_.jump();
        }
        if (plays && !played_.runs())
            cone_.reset();
        played_.turn(plays);
        if (plays)
            cone_.setLinearShareRemoved(mode == Mode::distortion ? 1.0 : 0.0);
    }
    if (mode != Mode::bypass && !wet_.on()) {
        plainGain_.jump(1.0);
        since_ = 0;
        loudest_ = 0.0;
    }
    wet_.turn(mode != Mode::bypass);
    bend_.set(controls.linearization);
    bend_.turn(bends);
    limit_ = bends ? controls.linearization.voltageLimit : std::numeric_limits<double>::infinity();
    if (controls.fullScale > 0.0 && std::isfinite(controls.fullScale) && controls.trim >= 0.0
        && std::isfinite(controls.trim)) {
        fullScale_.aim(controls.fullScale);
        if (mode != Mode::bypass) {
            before_.aim(plays ? 1.0 : controls.trim);
            after_.aim(plays ? controls.trim : 1.0);
        }
    }
}

void Chain::reset()
{
    bend_.reset();
    cone_.reset();
    coneRecovery_.reset();
    wet_.jump();
    played_.jump();
    for (auto* level : {&fullScale_, &before_, &after_})
        level->jump();
    plainGain_.jump(1.0);
    loudest_ = 0.0;
    since_ = 0;
    std::fill(plain_.begin(), plain_.end(), Passing {});
    plainAt_ = 0;
}

/// The cone's part, at the higher rate.
void Chain::play(std::size_t taken)
{
    double* const samples = bend_.between();
    for (std::size_t k = 0; k < taken; ++k) {
        const double weight = played_.step(), volume = coneRecovery_.step();
        for (int s = 0; s < factor_; ++s) {
            double& u = samples[k * static_cast<std::size_t>(factor_) + static_cast<std::size_t>(s)];
            double a = u;
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

void Chain::process(const double* in, double* out, std::size_t n)
{
    const FlushSubnormals flush;
    while (n > 0) {
        const bool runs = wet_.runs();
        const std::size_t taken = std::min(n, bend_.room());
        std::array<double, Predistorter::longestPart> scale, clean;
        for (std::size_t k = 0; k < taken; ++k) {
            const bool sound = std::isfinite(in[k]);
            clean[k] = sound ? in[k] : 0.0;
            scale[k] = fullScale_.step();
            block_[k] = in[k] * scale[k] * before_.step();
        }
        if (runs) {
            bend_.begin(block_.data(), taken);
            if (played_.runs())
                play(taken);
            bend_.finish(block_.data(), taken);
        }
        for (std::size_t k = 0; k < taken; ++k) {
            if (!runs && !std::isfinite(in[k]))
                faults_.fetch_add(1, std::memory_order_relaxed);
            Passing passing {clean[k], scale[k]};
            std::swap(passing, plain_[plainAt_]);
            plainAt_ = plainAt_ + 1 == plain_.size() ? 0 : plainAt_ + 1;
            const double weight = wet_.step(), trim = after_.step();
            double plain = passing.sample;
            if (weight < 1.0 && runs) {
                // Fading to or from what is kept to a limit of the voltage.
                loudest_ = std::max(loudest_, std::abs(clean[k] * scale[k]));
                plainGain_.aim(wet_.on() && loudest_ > limit_ ? limit_ / loudest_ : 1.0);
                plain *= plainGain_.step();
                if (wet_.on() && ++since_ > latency())
                    plain = std::clamp(plain, -limit_ / passing.fullScale, limit_ / passing.fullScale);
            }
            const double made = runs ? trim * block_[k] / passing.fullScale : plain;
            out[k] = withoutSubnormals(weight == 0.0 ? plain : plain + weight * (made - plain));
        }
        in += taken;
        out += taken;
        n -= taken;
    }
    displacement_.raise(peak_.displacement);
    current_.raise(peak_.current);
    peak_ = {};
    bend_.publish();
}

Chain::Meters Chain::take()
{
    const auto bend = bend_.take();
    return {bend, {displacement_.take(), current_.take(), 0}, bend.faults + faults_.load(std::memory_order_relaxed)};
}

}  // namespace excursion
