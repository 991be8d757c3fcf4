// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/Parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace excursion {

void inParallel(std::size_t count, unsigned threads, const Progress& progress,
                const std::function<bool(std::size_t)>& work)
{
    std::atomic<std::size_t> next {0};
    std::atomic<bool> failed {false};
    std::exception_ptr failure;
    std::mutex failureMutex;
    const auto run = [&] {
        for (std::size_t n = next++; n < count && !failed && !progress.stop.stop_requested(); n = next++) {
            try {
                if (!work(n))
                    failed = true;
            } catch (...) {
                const std::lock_guard lock(failureMutex);
                failure = std::current_exception();
                failed = true;
            }
        }
    };
    {
        std::vector<std::jthread> others;
        for (unsigned t = 1; t < std::min<std::size_t>(threads, count); ++t)
            others.emplace_back(run);
        run();
    }
    if (failure)
        std::rethrow_exception(failure);
    if (progress.stop.stop_requested())
        progress.at(0.0, "");
}

}  // namespace excursion
