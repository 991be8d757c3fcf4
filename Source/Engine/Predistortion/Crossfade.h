// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/Fade.h"
#include "Engine/Predistortion/Handover.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace excursion {

/// Plays the engine that was handed over last. When a new one comes, both run. The new one is silent at first, until
/// its memory of the signal is filled. Then the old one fades into the new. A third one that is offered meanwhile
/// waits. Before the first engine comes, the signal passes unchanged. Engines with
/// takeOver(const Engine& before) are given the old one as they come in. Engines have process(const double* in, double*
/// out, std::size_t n). If their latencies differ, the signal fades from one delay to the other.
template <class Engine>
class Crossfade {
public:
    /// @param fade  samples
    /// @param warm  samples before the fade, in which a new engine runs unheard
    explicit Crossfade(int fade, int warm = 0) : fade_(fade), length_(std::max(fade, 1)), warm_(std::max(warm, 0)) {}
    Crossfade(const Crossfade&) = delete;
    Crossfade& operator=(const Crossfade&) = delete;
    ~Crossfade()
    {
        delete old_;
        delete now_;
    }

    /// From any other thread: offers a complete engine.
    /// @param longer  additional samples that this engine runs unheard
    void offer(std::unique_ptr<Engine> engine, int longer = 0) { handover_.offer(std::move(engine), longer); }
    /// From any other thread, now and then: frees the retired engines.
    int collect() { return handover_.collect(); }

    /// Sets the first engine, before any audio runs.
    void start(std::unique_ptr<Engine> engine)
    {
        delete std::exchange(old_, nullptr);
        delete std::exchange(now_, new typename Handover<Engine>::Parcel {std::move(engine), nullptr, 0});
        left_ = 0;
    }

    /// On the audio thread, while nothing is heard: the engine that was offered last plays alone from here on.
    void jump()
    {
        accept();
        if (old_)
            handover_.retire(std::exchange(old_, nullptr));
        left_ = unheard_ = 0;
    }

    Engine* current() { return now_ ? now_->engine.get() : nullptr; }  ///< on the audio thread

    /// On the audio thread: calls work(engine) for every running engine, so that all get new controls.
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
                accept();
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
    /// An engine that was offered comes in beside the one that plays.
    void accept()
    {
        auto* parcel = handover_.accept();
        if (!parcel)
            return;
        if (old_)
            handover_.retire(old_);
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

    Handover<Engine> handover_;
    typename Handover<Engine>::Parcel *old_ = nullptr, *now_ = nullptr;
    Fade fade_;
    int length_, warm_, left_ = 0, unheard_ = 0;
    std::array<double, 256> before_ {};
};

}  // namespace excursion
