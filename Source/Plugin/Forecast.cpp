// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Forecast.h"

#include "Engine/Error.h"

#include <utility>

namespace excursion::plugin {

Forecast::Forecast() : thread_([this](const std::stop_token& stop) { run(stop); }) {}

Forecast::~Forecast()
{
    thread_.request_stop();
    changed_.notify_all();
}

void Forecast::ask(const Model& model, const PredistortionControls& controls, double volts)
{
    const std::lock_guard lock(mutex_);
    open_ = Question {model, controls, volts};
    changed_.notify_all();
}

std::optional<PredictedDistortion> Forecast::take()
{
    const std::lock_guard lock(mutex_);
    return std::exchange(answer_, std::nullopt);
}

void Forecast::run(const std::stop_token& stop)
{
    std::unique_lock lock(mutex_);
    while (changed_.wait(lock, stop, [this] { return open_.has_value(); })) {
        const auto question = *std::exchange(open_, std::nullopt);
        lock.unlock();
        std::optional<PredictedDistortion> answer;
        try {
            answer = predictDistortion(question.model, question.controls, question.volts);
        } catch (const Error&) {
            // A model that cannot be run has no distortion to tell.
        }
        lock.lock();
        answer_ = std::move(answer);
    }
}

}  // namespace excursion::plugin
