// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linearization/Chain.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

constexpr double fadeTime = 0.03;       // s, from mode to mode
constexpr double levelTime = 0.005;    // s, time constant of the levels

} // namespace

Chain::Chain(const Model& model, const RealTimeOptions& options, const ChainControls& controls)
    : bend_(static_cast<int>(fadeTime * options.sampleRate), model, options, controls.linearization),
      play_(static_cast<int>(fadeTime * options.sampleRate), model, options), perVolt_(1.0 / plateau(model)),
      smoothing_(1.0 - std::exp(-1.0 / (levelTime * options.sampleRate)))
{
    set(controls);
    reset();
}

void Chain::set(const ChainControls& controls)
{
    bend_.turn(controls.mode == Mode::linearize || controls.mode == Mode::audition);
    play_.turn(controls.mode == Mode::speaker || controls.mode == Mode::distortion || controls.mode == Mode::audition);
    if (controls.mode != Mode::bypass && controls.mode != Mode::linearize)
        play_.engine().setLinearShareRemoved(controls.mode == Mode::distortion ? 1.0 : 0.0);
    bend_.engine().set(controls.linearization);
    if (controls.fullScale > 0.0 && std::isfinite(controls.fullScale) && controls.trim >= 0.0 && std::isfinite(controls.trim))
        target_ = {controls.fullScale, controls.trim};
}

void Chain::reset()
{
    bend_.reset();
    play_.reset();
    now_ = target_;
}

void Chain::process(const double* in, double* out, std::size_t n)
{
    std::array<double, Stage<Speaker>::longestBlock> back;
    while (n > 0) {
        const std::size_t count = std::min(n, block_.size());
        for (std::size_t k = 0; k < count; ++k) {
            now_.fullScale += smoothing_ * (target_.fullScale - now_.fullScale);
            now_.trim += smoothing_ * (target_.trim - now_.trim);
            block_[k] = std::isfinite(in[k]) ? in[k] * now_.fullScale : 0.0;
            if (!std::isfinite(in[k]))
                faults_.fetch_add(1, std::memory_order_relaxed);
            back[k] = now_.trim / now_.fullScale;
        }
        bend_.process(block_.data(), count, 1.0);
        play_.process(block_.data(), count, perVolt_);
        for (std::size_t k = 0; k < count; ++k)
            out[k] = block_[k] * back[k];
        in += count;
        out += count;
        n -= count;
    }
}

Chain::Meters Chain::take()
{
    const auto bend = bend_.engine().take();
    const auto play = play_.engine().take();
    return {bend, play, bend.faults + play.faults + faults_.load(std::memory_order_relaxed)};
}

} // namespace excursion
