// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/AnyModel.h"

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace excursion::plugin {

/// Makes models without physics ready on a thread of its own, as a rehearsal takes seconds. Only the latest order is
/// carried out; one under way is stopped by the next. Not for the audio thread.
class Rehearsing {
public:
    /// The token tells that the order was cancelled meanwhile: then the model is not wanted any more.
    using Done = std::function<void(const LoadedBoxPointer&, const std::stop_token&)>;

    /// @param done  is given the model, on the thread; an Error that it throws is told as trouble, but for (cancelled)
    explicit Rehearsing(Done done);
    ~Rehearsing();

    void load(nlohmann::ordered_json document, const std::string& where);
    void cancel();

    struct Status {
        bool busy = false;
        double fraction = 0.0;
        std::string words;          ///< what the last order came to: the gain, why there is none, or why it was refused
        bool trouble = false;       ///< it was refused, and nothing has changed
        std::uint64_t version = 0;  ///< counts orders that came to something
    };
    Status status() const;
    void wait() const;  ///< until nothing is under way

private:
    struct Order {
        nlohmann::ordered_json document;
        std::string where;
    };
    void run(const std::stop_token&);

    Done done_;
    mutable std::mutex mutex_;  ///< of what follows
    mutable std::condition_variable_any changed_;
    std::optional<Order> open_;
    std::stop_source stop_;  ///< of the order under way
    bool working_ = false;
    Status status_;
    std::jthread thread_;
};

}  // namespace excursion::plugin
