// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <memory>
#include <utility>

namespace excursion {

/// Hands a new engine (a Predistorter, a Speaker, or anything) to the audio thread and takes the old one back, without
/// a lock:
///  - offer() and collect() are for other threads: they allocate and free;
///  - accept() and retire() are for the audio thread, one at a time: two atomic exchanges, nothing else.
/// An engine that was offered and not yet accepted is replaced by the next one.
template <class Engine>
class Handover {
public:
    /// An engine in an envelope that can be put on a list without allocating.
    struct Parcel {
        std::unique_ptr<Engine> engine;
        Parcel* next = nullptr;
        int warm = 0;  ///< samples that the engine needs to run unheard at first
    };

    Handover() = default;
    Handover(const Handover&) = delete;
    Handover& operator=(const Handover&) = delete;
    ~Handover()
    {
        delete offered_.exchange(nullptr, std::memory_order_acquire);
        collect();
    }

    void offer(std::unique_ptr<Engine> engine, int warm = 0)
    {
        delete offered_.exchange(new Parcel {std::move(engine), nullptr, warm}, std::memory_order_acq_rel);
    }

    /// Frees the retired engines.
    /// @returns how many engines
    int collect()
    {
        int count = 0;
        for (Parcel* parcel = retired_.exchange(nullptr, std::memory_order_acquire); parcel; ++count)
            delete std::exchange(parcel, parcel->next);
        return count;
    }

    /// The latest offer, or nullptr; the caller owns it until retire().
    Parcel* accept()
    {
        // A plain load first: an exchange at every block would fetch the cache line from the other thread each time.
        return offered_.load(std::memory_order_relaxed) ? offered_.exchange(nullptr, std::memory_order_acquire)
                                                        : nullptr;
    }

    void retire(Parcel* parcel)
    {
        parcel->next = retired_.load(std::memory_order_relaxed);
        while (!retired_.compare_exchange_weak(parcel->next, parcel, std::memory_order_release,
                                               std::memory_order_relaxed)) {}
    }

private:
    static_assert(std::atomic<Parcel*>::is_always_lock_free);
    std::atomic<Parcel*> offered_ {nullptr}, retired_ {nullptr};
};

}  // namespace excursion
