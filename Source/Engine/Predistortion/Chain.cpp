// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/Chain.h"

#include "Engine/Predistortion/DriverEngine.h"
#include "Engine/Predistortion/Subnormals.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace excursion {
namespace {

constexpr double fadeTime = 0.05;     // s, from mode to mode
constexpr double levelTime = 0.005;   // s, see Glide
constexpr double plainTime = 0.0003;  // s, see Glide: gone within the latency

/// The factors before and after the engine, whose product is the trim.
/// @param place  1: all of it before, 0: all of it after
std::pair<double, double> split(double trim, double place)
{
    constexpr double silent = 1e-6;
    const double before = place >= 1.0 ? trim : place <= 0.0 ? 1.0 : std::pow(std::max(trim, silent), place);
    return {before, before > 0.0 ? trim / before : 1.0};
}

}  // namespace

Chain::Chain(const Model& model, const RealTimeOptions& options, const ChainControls& controls)
    : Chain(std::make_unique<DriverEngine>(model, options, controls.predistortion), options.sampleRate, controls)
{
}

Chain::Chain(std::unique_ptr<ChainEngine> engine, double sampleRate, const ChainControls& controls)
    : engine_(std::move(engine)),
      wet_(static_cast<int>(fadeTime * sampleRate), engine_->latency()),
      played_(static_cast<int>(fadeTime * sampleRate), 0),
      fullScale_(levelTime, sampleRate),
      trim_(levelTime, sampleRate),
      place_(levelTime, sampleRate),
      plainGain_(plainTime, sampleRate, 1.0),
      plain_(static_cast<std::size_t>(engine_->latency()))
{
    set(controls);
    reset();
}

void Chain::set(const ChainControls& controls)
{
    const auto mode = controls.mode;
    const bool atRest = !wet_.runs();
    const bool bends = mode == Mode::linearize || mode == Mode::audition,
               plays = mode != Mode::bypass && mode != Mode::linearize;
    if (mode != Mode::bypass) {
        if (atRest) {  // what is switched in finds nothing of before but heat and charge
            const auto left = engine_->warmth();
            engine_->resetBending();
            engine_->warm(left);
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
    strict_ = mode == Mode::linearize;
    if (!bends)
        limit_ = std::numeric_limits<double>::infinity();
    else if (controls.predistortion.areSound())
        limit_ = controls.predistortion.voltageLimit;
    if (controls.fullScale > 0.0 && std::isfinite(controls.fullScale) && controls.trim >= 0.0
        && std::isfinite(controls.trim)) {
        fullScale_.aim(controls.fullScale);
        if (mode != Mode::bypass) {
            trim_.aim(controls.trim);
            place_.aim(plays ? 0.0 : 1.0);
        }
        if (mode != Mode::bypass && atRest) {
            trim_.jump();
            place_.jump();
        }
    }
}

void Chain::takeOver(const Chain& before) { engine_->warm(before.engine_->warmth()); }

void Chain::reset()
{
    engine_->reset();
    wet_.jump();
    played_.jump();
    for (auto* level : {&fullScale_, &trim_, &place_})
        level->jump();
    plainGain_.jump(1.0);
    loudest_ = 0.0;
    since_ = 0;
    std::fill(plain_.begin(), plain_.end(),
              Passing {0.0, fullScale_.target(), split(trim_.target(), place_.target()).second});
    plainAt_ = 0;
}

void Chain::settle()
{
    const auto left = engine_->warmth();
    reset();
    engine_->warm(left);
}

/// What went in at the time of what comes out now.
Chain::Passing Chain::delayed(Passing passing)
{
    if (plain_.empty())
        return passing;
    std::swap(passing, plain_[plainAt_]);
    plainAt_ = plainAt_ + 1 == plain_.size() ? 0 : plainAt_ + 1;
    return passing;
}

/// The engine rests, and the loudspeaker is given the samples as they are.
void Chain::rest(const Passing* passing, std::size_t n)
{
    for (std::size_t k = 0; k < n; ++k)
        block_[k] = passing[k].sample * passing[k].fullScale;
    engine_->pass(block_.data(), n);
}

void Chain::process(const double* in, double* out, std::size_t n)
{
    const FlushSubnormals flush;
    bool ran = false;
    while (n > 0) {
        const bool runs = wet_.runs();
        ran = ran || runs;
        const std::size_t taken = std::min(n, engine_->room());
        std::array<Passing, ChainEngine::longestPart> passing;
        for (std::size_t k = 0; k < taken; ++k) {
            const auto [before, after] = split(trim_.step(), place_.step());
            passing[k] = {std::isfinite(in[k]) ? in[k] : 0.0, fullScale_.step(), after};
            block_[k] = in[k] * passing[k].fullScale * before;
        }
        const bool soundFades = played_.runs();
        if (runs)
            engine_->process(block_.data(), taken, played_);
        else
            rest(passing.data(), taken);
        for (std::size_t k = 0; k < taken; ++k) {
            if (!runs && !std::isfinite(in[k]))
                faults_.fetch_add(1, std::memory_order_relaxed);
            const auto then = delayed(passing[k]);
            const double unit = then.fullScale, weight = wet_.step();
            double plain = then.sample;
            if (weight < 1.0 && runs) {
                // Fading to or from what is kept to a limit of the voltage.
                loudest_ = std::max(loudest_, std::abs(passing[k].sample * passing[k].fullScale));
                plainGain_.aim(wet_.on() && loudest_ > limit_ ? limit_ / loudest_ : 1.0);
                plain *= plainGain_.step();
                if (wet_.on() && ++since_ > latency())
                    plain = std::clamp(plain, -limit_ / unit, limit_ / unit);
            }
            double made = runs ? then.trimAfter * block_[k] / unit : plain;
            // The engine keeps to the limit; what still comes behind it may not.
            if (runs && strict_ && (then.trimAfter != 1.0 || soundFades))
                made = std::clamp(made, -limit_ / unit, limit_ / unit);
            // While the volts at full scale fall, the engine's limit comes after them.
            if (runs && strict_ && limit_ <= fullScale_.target())
                made = std::clamp(made, -1.0, 1.0);
            out[k] = weight == 0.0 ? plain : withoutSubnormals(plain + weight * (made - plain));
        }
        in += taken;
        out += taken;
        n -= taken;
    }
    if (ran)  // what rests has nothing to tell, and would tell what it did last again and again
        engine_->publish();
}

Chain::Meters Chain::collectMeters()
{
    auto meters = engine_->collectMeters();
    meters.faults += faults_.load(std::memory_order_relaxed);
    return meters;
}

}  // namespace excursion
