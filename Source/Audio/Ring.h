// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstddef>
#include <span>
#include <vector>

namespace excursion::audio {

/// Frames of samples from one thread to another, in their order. Neither waits: no lock, and no allocation after the
/// construction, which also touches all of the memory, so that no page has to be found later.
class Ring {
public:
    /// @param frameSize  samples a frame
    Ring(std::size_t frameSize, std::size_t frames) : frameSize_(frameSize), frames_(frames), store_(frameSize * frames)
    {
    }

    /// The writing thread: false, and nothing is written, when the ring is full.
    bool write(std::span<const float> frame) noexcept
    {
        const auto written = written_.load(std::memory_order_relaxed);
        if (written - read_.load(std::memory_order_acquire) >= frames_)
            return false;
        float* const place = store_.data() + (written % frames_) * frameSize_;
        for (std::size_t k = 0; k < frameSize_; ++k)
            place[k] = frame[k];
        written_.store(written + 1, std::memory_order_release);
        return true;
    }

    /// The reading thread: appends to one vector a sample of the frame. @return the frames
    std::size_t read(std::vector<std::vector<float>>& channels)
    {
        const auto from = read_.load(std::memory_order_relaxed), to = written_.load(std::memory_order_acquire);
        for (auto n = from; n < to; ++n)
            for (std::size_t k = 0; k < frameSize_; ++k)
                channels[k].push_back(store_[(n % frames_) * frameSize_ + k]);
        read_.store(to, std::memory_order_release);
        return to - from;
    }

private:
    const std::size_t frameSize_, frames_;
    std::vector<float> store_;
    std::atomic<std::size_t> written_ {0}, read_ {0};
    static_assert(std::atomic<std::size_t>::is_always_lock_free);
};

}  // namespace excursion::audio
