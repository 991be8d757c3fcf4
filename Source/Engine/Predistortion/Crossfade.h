// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/Fade.h"
#include "Engine/Predistortion/Handover.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace excursion {

/// Plays the engine that was handed over last: when a new one comes, both run, the new one unheard at first, until what
/// it has to remember of the signal is there, and then the old one fades into the new. A third that is offered
/// meanwhile waits. Where engines have takeOver(const Engine& before), the new one is told of the old one as it comes
/// in. Until the first one comes the signal goes through as it is. Engines have process(const double* in,
/// double* out, std::size_t n); where their latencies differ, the signal fades from one time to the other.
template <class Engine>
class Crossfade {
public:
    /// @param fade  samples
    /// @param warm  samples before it, in which a new engine runs unheard
    explicit Crossfade(int fade, int warm = 0) : fade_(fade), length_(std::max(fade, 1)), warm_(std::max(warm, 0)) {}
    Crossfade(const Crossfade&) = delete;
    Crossfade& operator=(const Crossfade&) = delete;
    ~Crossfade()
    {
        delete old_;
        delete now_;
    }

    /// From any other thread: an engine that is built and warm.
    /// @param longer  samples that this one runs unheard beyond those of all
    void offer(std::unique_ptr<Engine> engine, int longer = 0) { handover_.offer(std::move(engine), longer); }
    /// From any other thread, now and then: frees the engines that are done.
    int collect() { return handover_.collect(); }

    /// Starts with this one, before any audio runs.
    void start(std::unique_ptr<Engine> engine)
    {
        delete std::exchange(old_, nullptr);
        delete std::exchange(now_, new typename Handover<Engine>::Parcel {std::move(engine), nullptr, 0});
        left_ = 0;
    }

    Engine* current() { return now_ ? now_->engine.get() : nullptr; }  ///< on the audio thread

    /// On the audio thread: work(engine) for every engine that runs, so that all hear of new controls.
    template <class Work>
    void each(const Work& work)
    {
        for (auto* parcel : {old_, now_})
            if (parcel)
                work(*parcel->engine);
    }

    /// On the audio thread. `in` and `out` may be the same place.
    void process(const double* in, double* out, std::size_t n)
    {
        while (n > 0) {
            if (left_ == 0 && !old_)
                if (auto* parcel = handover_.accept()) {
                    old_ = now_;
                    now_ = parcel;
                    if constexpr (requires(Engine & next, const Engine& before) { next.takeOver(before); })
                        if (old_)
                            now_->engine->takeOver(*old_->engine);
                    unheard_ = warm_ + std::max(parcel->warm, 0);
                    left_ = unheard_ + length_;
                    fade_.turn(false);
                    fade_.jump();
                    fade_.turn(true);
                }
            const std::size_t count = left_ > 0 ? std::min({n, before_.size(), static_cast<std::size_t>(left_)}) : n;
            if (left_ > 0) {
                if (old_)
                    old_->engine->process(in, before_.data(), count);
                else
                    std::copy(in, in + count, before_.data());
                now_->engine->process(in, out, count);
                for (std::size_t k = 0; k < count; ++k) {
                    --left_;
                    const double weight = unheard_ > 0 ? (--unheard_, 0.0) : fade_.step();
                    out[k] = before_[k] + weight * (out[k] - before_[k]);
                }
                if (left_ == 0 && old_)
                    handover_.retire(std::exchange(old_, nullptr));
            } else if (now_) {
                now_->engine->process(in, out, count);
            } else if (in != out) {
                std::copy(in, in + count, out);
            }
            in += count;
            out += count;
            n -= count;
        }
    }

private:
    Handover<Engine> handover_;
    typename Handover<Engine>::Parcel *old_ = nullptr, *now_ = nullptr;
    Fade fade_;
    int length_, warm_, left_ = 0, unheard_ = 0;
    std::array<double, 256> before_ {};
};

}  // namespace excursion
