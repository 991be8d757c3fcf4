// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/Chain.h"

#include "Engine/Predistortion/DriverEngine.h"
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
    : Chain(std::make_unique<DriverEngine>(model, options, controls.predistortion), options.sampleRate, controls)
{
}

Chain::Chain(std::unique_ptr<ChainEngine> engine, double sampleRate, const ChainControls& controls)
    : engine_(std::move(engine)),
      rate_(sampleRate),
      wet_(static_cast<int>(fadeTime * sampleRate), engine_->latency()),
      played_(static_cast<int>(fadeTime * sampleRate), 0),
      fullScale_(levelTime, sampleRate),
      before_(levelTime, sampleRate),
      after_(levelTime, sampleRate),
      plainGain_(plainTime, sampleRate, 1.0),
      plain_(static_cast<std::size_t>(engine_->latency()))
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
        if (!wet_.runs()) {  // what is switched in finds nothing of before but the coil's heat
            const double left = heat();
            engine_->resetBending();
            engine_->warm(left);
            rest_ = 0.0;
            played_.turn(plays);
            played_.jump();
            if (plays)
                engine_->resetPlaying();
        }
        if (plays && !played_.runs())
            engine_->resetPlaying();
        played_.turn(plays);
        if (plays)
            engine_->setLinearShareRemoved(mode == Mode::distortion ? 1.0 : 0.0);
    }
    if (mode != Mode::bypass && !wet_.on()) {
        plainGain_.jump(1.0);
        since_ = 0;
        loudest_ = 0.0;
    }
    wet_.turn(mode != Mode::bypass);
    engine_->set(controls.predistortion);
    engine_->turn(bends);
    limit_ = bends ? controls.predistortion.voltageLimit : std::numeric_limits<double>::infinity();
    if (controls.fullScale > 0.0 && std::isfinite(controls.fullScale) && controls.trim >= 0.0
        && std::isfinite(controls.trim)) {
        fullScale_.aim(controls.fullScale);
        if (mode != Mode::bypass) {
            before_.aim(plays ? 1.0 : controls.trim);
            after_.aim(plays ? controls.trim : 1.0);
        }
    }
}

/// W, of the coil, which cools while the engine rests.
double Chain::heat() const
{
    return engine_->heat() * std::exp(-rest_ / (rate_ * PredistortionControls::averagingTime));
}

void Chain::takeOver(const Chain& before)
{
    engine_->warm(before.heat());
    rest_ = 0.0;
}

void Chain::reset()
{
    engine_->reset();
    rest_ = 0.0;
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

/// The plain sample of the time of what comes out now.
double Chain::delayed(double sample, double& scale)
{
    if (plain_.empty())
        return sample;
    Passing passing {sample, scale};
    std::swap(passing, plain_[plainAt_]);
    plainAt_ = plainAt_ + 1 == plain_.size() ? 0 : plainAt_ + 1;
    scale = passing.fullScale;
    return passing.sample;
}

void Chain::process(const double* in, double* out, std::size_t n)
{
    const FlushSubnormals flush;
    while (n > 0) {
        const bool runs = wet_.runs();
        const std::size_t taken = std::min(n, engine_->room());
        std::array<double, ChainEngine::longestPart> scale, clean;
        for (std::size_t k = 0; k < taken; ++k) {
            const bool sound = std::isfinite(in[k]);
            clean[k] = sound ? in[k] : 0.0;
            scale[k] = fullScale_.step();
            block_[k] = in[k] * scale[k] * before_.step();
        }
        if (runs)
            engine_->process(block_.data(), taken, played_);
        else
            rest_ += static_cast<double>(taken);
        for (std::size_t k = 0; k < taken; ++k) {
            if (!runs && !std::isfinite(in[k]))
                faults_.fetch_add(1, std::memory_order_relaxed);
            double unit = scale[k], plain = delayed(clean[k], unit);
            const double weight = wet_.step(), trim = after_.step();
            if (weight < 1.0 && runs) {
                // Fading to or from what is kept to a limit of the voltage.
                loudest_ = std::max(loudest_, std::abs(clean[k] * scale[k]));
                plainGain_.aim(wet_.on() && loudest_ > limit_ ? limit_ / loudest_ : 1.0);
                plain *= plainGain_.step();
                if (wet_.on() && ++since_ > latency())
                    plain = std::clamp(plain, -limit_ / unit, limit_ / unit);
            }
            const double made = runs ? trim * block_[k] / unit : plain;
            out[k] = withoutSubnormals(weight == 0.0 ? plain : plain + weight * (made - plain));
        }
        in += taken;
        out += taken;
        n -= taken;
    }
    engine_->publish();
}

Chain::Meters Chain::collectMeters()
{
    auto meters = engine_->collectMeters();
    meters.faults += faults_.load(std::memory_order_relaxed);
    return meters;
}

}  // namespace excursion
