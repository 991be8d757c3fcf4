// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>

namespace excursion {

/// A peak for meters: one thread raises it and another reads it. A peak that comes while it is read may be lost.
class Peak {
public:
    void raise(double value)
    {
        if (value > peak_.load(std::memory_order_relaxed))
            peak_.store(value, std::memory_order_relaxed);
    }
    double readAndReset() { return peak_.exchange(0.0, std::memory_order_relaxed); }

private:
    static_assert(std::atomic<double>::is_always_lock_free);
    std::atomic<double> peak_ {0.0};
};

}  // namespace excursion
