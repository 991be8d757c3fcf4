// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace excursion::plugin {

/// Keeps an answer that takes long up to date on a thread of its own; only the latest question is answered. Not for the
/// audio thread.
template <class Answer>
class Forecast {
public:
    using Question = std::function<Answer()>;  ///< does not throw

    Forecast() : thread_([this](const std::stop_token& stop) { run(stop); }) {}
    ~Forecast()
    {
        thread_.request_stop();
        changed_.notify_all();
    }

    void ask(Question question)
    {
        const std::lock_guard lock(mutex_);
        open_ = std::move(question);
        changed_.notify_all();
    }

    /// The answer, once.
    std::optional<Answer> collect()
    {
        const std::lock_guard lock(mutex_);
        return std::exchange(answer_, std::nullopt);
    }

private:
    void run(const std::stop_token& stop)
    {
        std::unique_lock lock(mutex_);
        while (changed_.wait(lock, stop, [this] { return open_.has_value(); })) {
            const auto question = *std::exchange(open_, std::nullopt);
            lock.unlock();
            auto answer = question();
            lock.lock();
            answer_ = std::move(answer);
        }
    }

    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::optional<Question> open_;
    std::optional<Answer> answer_;
    std::jthread thread_;
};

}  // namespace excursion::plugin
