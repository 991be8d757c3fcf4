// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Progress.h"

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace excursion::plugin {

/// Keeps an answer that takes long up to date on a thread of its own; of the questions that wait, only the
/// latest is answered. The destructor stops what is under way. Not for the audio thread.
template <class Answer>
class Forecast {
public:
    /// Throws nothing but Error (cancelled).
    using Question = std::function<Answer(const Progress&)>;

    Forecast() : thread_([this](const std::stop_token& stop) { run(stop); }) {}
    ~Forecast()
    {
        thread_.request_stop();
        const std::lock_guard lock(mutex_);
        stop_.request_stop();
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
            if (stop.stop_requested())
                return;
            const auto question = *std::exchange(open_, std::nullopt);
            stop_ = std::stop_source();
            Progress progress;
            progress.stop = stop_.get_token();
            lock.unlock();
            std::optional<Answer> answer;
            try {
                answer = question(progress);
            } catch (const Error&) {  // another question follows, or none
            }
            lock.lock();
            if (answer)
                answer_ = std::move(answer);
        }
    }

    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::optional<Question> open_;
    std::stop_source stop_;  ///< of the question that is being answered
    std::optional<Answer> answer_;
    std::jthread thread_;
};

}  // namespace excursion::plugin
