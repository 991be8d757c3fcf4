// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Measuring.h"

#include "Engine/Error.h"

#include <chrono>
#include <cmath>
#include <utility>

namespace excursion::plugin {

Measuring::Measuring(std::unique_ptr<OpenDevice> device, Measurement plan, std::vector<InputRole> roles,
                     double fullScale)
    : device_(std::move(device)), plan_(std::move(plan)), roles_(std::move(roles)), fullScale_(fullScale)
{
    audio::MeasureOptions options;
    options.procedure = audio::procedureFor(plan_, {}, fullScale);
    options.procedure.recorded = static_cast<int>(roles_.size());
    for (std::size_t k = 0; k < roles_.size(); ++k)
        options.procedure.inputs.push_back(
            {static_cast<int>(k), roles_[k].quantity, roles_[k].fullScale, roles_[k].limit});
    // room for all of it, so that nothing is lost while the computer does something else
    options.procedure.ringSeconds = static_cast<double>(options.procedure.sound.size()) / options.procedure.sampleRate
                                    + options.procedure.pause + options.procedure.tail + 1.0;
    if (std::string reason; !options.procedure.isValid(&reason))
        throw Error(Error::Kind::usage, reason);
    options.stop = stop_.get_token();
    options.report = [this](const audio::Status& status) {
        const std::lock_guard lock(mutex_);
        status_ = status;
    };
    result_ = std::async(std::launch::async, [this, options = std::move(options)] {
        return audio::measure(*device_, device_->devices().front(), options);
    });
}

Measuring::~Measuring()
{
    stop();
    if (result_.valid())
        result_.wait();
}

bool Measuring::ended() const
{
    return !result_.valid() || result_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

audio::Status Measuring::status() const
{
    const std::lock_guard lock(mutex_);
    return status_;
}

Recorded Measuring::recorded()
{
    auto measured = result_.get();
    Recorded recorded;
    recorded.device = device_->description();
    recorded.remarks = std::move(measured.remarks);
    recorded.fullScale = fullScale_;
    recorded.recording.plan = std::move(plan_);
    Wav sound {static_cast<int>(std::lround(recorded.recording.plan->sampleRate)), {}};
    for (std::size_t k = 0; k < roles_.size(); ++k) {
        sound.channels.emplace_back(measured.channels[k].begin(), measured.channels[k].end());
        ChannelMapping mapping;
        mapping.channel = static_cast<int>(k) + 1;
        mapping.quantity = roles_[k].quantity;
        mapping.fullScale = roles_[k].fullScale;
        recorded.recording.map.push_back(std::move(mapping));
    }
    recorded.recording.sounds.push_back({"the recording", std::move(sound)});
    return recorded;
}

}  // namespace excursion::plugin
