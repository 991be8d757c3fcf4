// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace excursion {

/// An engine in a row of engines, which can be switched in and out while a signal runs: what it makes fades into the signal as it is, delayed by
/// the engine's latency, and back. While it is out it does not run, and it starts anew when it is switched in.
template <class Engine>
class Stage {
public:
    static constexpr std::size_t longestBlock = 64;

    /// @param fade  samples
    template <class... Arguments>
    explicit Stage(int fade, const Arguments&... arguments)
        : engine_(arguments...), delay_(static_cast<std::size_t>(engine_.latency()), 0.0), fade_(std::max(fade, 1))
    {
    }

    Engine& engine() { return engine_; }
    int latency() const { return engine_.latency(); }
    bool runs() const { return on_ || place_ > 0; }

    void reset()
    {
        engine_.reset();
        std::fill(delay_.begin(), delay_.end(), 0.0);
        at_ = 0;
        place_ = on_ ? fade_ : 0;
    }
    void turn(bool on)
    {
        if (on && !runs())
            engine_.reset();
        on_ = on;
    }

    /// @param q     n <= longestBlock samples, in place
    /// @param gain  of what the engine makes
    void process(double* q, std::size_t n, double gain)
    {
        const bool running = runs();
        if (running) {
            std::copy(q, q + n, made_.begin());
            engine_.process(made_.data(), made_.data(), n);
        }
        for (std::size_t k = 0; k < n; ++k) {
            double plain = q[k];
            if (!delay_.empty()) {
                std::swap(plain, delay_[at_]);
                at_ = at_ + 1 == delay_.size() ? 0 : at_ + 1;
            }
            if (!running) {
                q[k] = plain;
                continue;
            }
            place_ = on_ ? std::min(place_ + 1, fade_) : std::max(place_ - 1, 0);
            const double share = static_cast<double>(place_) / fade_, weight = share * share * (3.0 - 2.0 * share);
            q[k] = plain + weight * (gain * made_[k] - plain);
        }
    }

private:
    Engine engine_;
    std::vector<double> delay_;
    std::size_t at_ = 0;
    int fade_, place_ = 0;
    bool on_ = false;
    std::array<double, longestBlock> made_ {};
};

} // namespace excursion
