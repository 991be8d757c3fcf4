// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Rehearsing.h"

#include "Engine/Error.h"

#include <utility>

namespace excursion::plugin {

Rehearsing::Rehearsing(Done done) : done_(std::move(done)), thread_([this](const std::stop_token& stop) { run(stop); })
{
}

Rehearsing::~Rehearsing()
{
    cancel();
    thread_.request_stop();
    changed_.notify_all();
}

void Rehearsing::load(nlohmann::ordered_json document, const std::string& where)
{
    const std::lock_guard lock(mutex_);
    stop_.request_stop();
    open_ = Order {std::move(document), where};
    status_.busy = true;
    status_.fraction = 0.0;
    changed_.notify_all();
}

void Rehearsing::cancel()
{
    const std::lock_guard lock(mutex_);
    open_.reset();
    stop_.request_stop();
    status_.busy = working_;
    changed_.notify_all();
}

Rehearsing::Status Rehearsing::status() const
{
    const std::lock_guard lock(mutex_);
    return status_;
}

void Rehearsing::wait() const
{
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !status_.busy; });
}

void Rehearsing::run(const std::stop_token& stop)
{
    std::unique_lock lock(mutex_);
    while (changed_.wait(lock, stop, [this] { return open_.has_value(); })) {
        const auto order = *std::exchange(open_, std::nullopt);
        stop_ = std::stop_source();
        working_ = true;
        Progress progress;
        progress.stop = stop_.get_token();
        progress.report = [this](double fraction, std::string_view) {
            const std::lock_guard inner(mutex_);
            status_.fraction = fraction;
        };
        lock.unlock();
        std::string said;
        bool trouble = false, cancelled = false;
        try {
            const auto box = loadedBox(order.document, order.where, progress);
            progress.at(1.0, "");
            done_(box, progress.stop);
            said = wordsOf(box->played);
        } catch (const Error& error) {
            trouble = true;
            cancelled = error.kind() == Error::Kind::cancelled;
            said = error.what();
        } catch (const std::exception& error) {
            trouble = true;
            said = std::string("This went wrong: ") + error.what() + ".";
        }
        lock.lock();
        working_ = false;
        status_.busy = open_.has_value();
        if (!cancelled) {
            status_.words = said;
            status_.trouble = trouble;
            ++status_.version;
        }
        changed_.notify_all();
    }
}

}  // namespace excursion::plugin
