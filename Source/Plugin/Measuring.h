// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Audio/Measure.h"
#include "Engine/Import/RecordingOptions.h"
#include "Plugin/OpenDevice.h"

#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace excursion::plugin {

/// Which input of the audio device is what.
struct InputRole {
    int input = 0;  ///< of the device, from 0
    Quantity quantity = Quantity::voltage;
    double fullScale = 1.0;       ///< quantity at a sample of 1.0, SI unit
    std::optional<double> limit;  ///< of its magnitude, SI unit: ends the measurement
};

/// What was measured, to be laid beside its plan.
struct Recorded {
    RecordingOptions recording;
    std::string device;
    std::vector<std::string> remarks;
    double fullScale = 0.0;  ///< V at the loudspeaker for an output sample of 1.0
};

/// A measurement by audio::measure() through an open device, on a thread of its own: the level rises, and it fades out
/// where a limit is reached or it is stopped. All methods on the message thread; the destructor stops it.
class Measuring {
public:
    /// @param roles      of the inputs that `device` hands on, in their order
    /// @param fullScale  V at the loudspeaker for an output sample of 1.0
    /// Throws Error: data for a plan that the output cannot play, usage for a limit that its input cannot reach.
    Measuring(std::unique_ptr<OpenDevice> device, Measurement plan, std::vector<InputRole> roles, double fullScale);
    ~Measuring();

    void stop() { stop_.request_stop(); }
    bool ended() const;
    audio::Status status() const;
    const std::vector<InputRole>& roles() const { return roles_; }
    Recorded recorded();  ///< once, when it has ended; throws as audio::measure()

private:
    const std::unique_ptr<OpenDevice> device_;
    Measurement plan_;
    const std::vector<InputRole> roles_;
    const double fullScale_;
    std::stop_source stop_;
    mutable std::mutex mutex_;
    audio::Status status_;
    std::future<audio::Measured> result_;
};

}  // namespace excursion::plugin
