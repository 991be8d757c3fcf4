// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/PredictedDistortion.h"

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

namespace excursion::plugin {

/// Keeps a prediction of the distortion up to date on a thread of its own; only the latest question is answered. Not
/// for the audio thread.
class Forecast {
public:
    Forecast();
    ~Forecast();

    void ask(const Model&, const PredistortionControls&, double volts);

    /// The answer, once.
    std::optional<PredictedDistortion> take();

private:
    struct Question {
        Model model;
        PredistortionControls controls;
        double volts = 0.0;
    };
    void run(const std::stop_token&);

    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::optional<Question> open_;
    std::optional<PredictedDistortion> answer_;
    std::jthread thread_;
};

}  // namespace excursion::plugin
