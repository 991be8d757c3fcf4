// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Session.h"

#include "Bench/Draw.h"
#include "Engine/Error.h"
#include "Engine/Import/ImportRecording.h"
#include "Engine/Import/ReadTake.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Take/TakeFile.h"
#include "Report/Report.h"

#include <filesystem>

namespace excursion::plugin {
namespace {

std::string titlesOf(const std::vector<bench::HiddenEffect>& hidden)
{
    std::string text;
    for (const auto& effect : hidden) {
        text += text.empty() ? "" : ", ";
        for (const auto* known : catalogue())
            if (known->id() == effect.id)
                text += known->title();
    }
    return text.empty() ? "nothing" : text;
}

Findings from(const std::string& source)
{
    Findings told;
    told.source = source;
    return told;
}

}  // namespace

Session::Session() : thread_([this](const std::stop_token& stop) { run(stop); }) {}

Session::~Session()
{
    cancel();
    thread_.request_stop();
    changed_.notify_all();
}

void Session::order(Work work)
{
    const std::lock_guard lock(mutex_);
    orders_.push_back(std::move(work));
    status_.busy = true;
    changed_.notify_all();
}

void Session::cancel()
{
    const std::lock_guard lock(mutex_);
    orders_.clear();
    shape_.reset();
    stop_.request_stop();
    status_.busy = working_;
    changed_.notify_all();
}

void Session::run(const std::stop_token& stop)
{
    std::unique_lock lock(mutex_);
    for (;;) {
        if (!changed_.wait(lock, stop, [this] { return !orders_.empty(); }))
            return;
        const auto work = std::move(orders_.front());
        orders_.erase(orders_.begin());
        stop_ = std::stop_source();
        working_ = true;
        status_.fraction = 0.0;
        status_.trouble = false;
        Progress progress;
        progress.stop = stop_.get_token();
        progress.report = [this](double fraction, std::string_view words) {
            const std::lock_guard inner(mutex_);
            status_.fraction = fraction;
            status_.words = words;
        };
        lock.unlock();
        std::string trouble;
        try {
            work(progress);
        } catch (const Error& error) {
            trouble = error.kind() == Error::Kind::cancelled ? "Cancelled." : error.what();
        } catch (const std::exception& error) {
            trouble = std::string("This went wrong: ") + error.what() + ".";
        }
        lock.lock();
        if (!trouble.empty()) {
            status_.words = trouble;
            status_.trouble = true;
        }
        working_ = false;
        status_.busy = !orders_.empty();
        changed_.notify_all();
    }
}

void Session::wait() const
{
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !status_.busy; });
}

Session::Status Session::status() const
{
    const std::lock_guard lock(mutex_);
    return status_;
}

std::shared_ptr<const Findings> Session::findings() const
{
    const std::lock_guard lock(mutex_);
    return findings_;
}

void Session::publish(std::shared_ptr<Findings> fresh)
{
    const std::lock_guard lock(mutex_);
    findings_ = std::move(fresh);
    ++status_.version;
}

void Session::say(const std::string& words)
{
    const std::lock_guard lock(mutex_);
    status_.words = words;
}

Improvement& Session::improvement()
{
    if (!improvement_ || improvement_->ladder().rungs.empty())
        throw Error(Error::Kind::usage, "There is no model of a take yet: open a take that is fit for use first.");
    return *improvement_;
}

/// The findings with the ladder as it is now.
void Session::publishLadder()
{
    auto fresh = std::make_shared<Findings>(*findings());
    if (fresh->file.responses.empty())
        fresh->file = makeLadderFile(improvement_->ladder(), *fresh->take, fresh->source);
    else {
        fresh->file.ladder = improvement_->ladder();
        fresh->file.whatIf = whatIfOf(fresh->file.ladder.model(), *fresh->take);
    }
    fresh->waveforms.clear();
    const auto& levels = improvement_->ladder().rungs.back().comparison.levels;
    for (std::size_t level = 0; level < levels.size(); ++level)
        fresh->waveforms.push_back(improvement_->waveforms(static_cast<int>(level)));
    publish(fresh);
    say(improvement_->ladder().sentence);
}

void Session::begin(PreparedTake take, const Findings& told, const Progress& progress)
{
    Improvement work(take, {}, progress.part(0.0, 0.05));
    auto fresh = std::make_shared<Findings>(told);
    fresh->report = take.report();
    fresh->file = makeLadderFile(work.ladder(), take, told.source);
    fresh->take = std::make_shared<const PreparedTake>(std::move(take));
    put({});  // those of another take
    publish(fresh);
    improvement_.emplace(std::move(work));
    if (!improvement_->take().report().fitForUse()) {
        say(improvement_->take().report().verdict());
        return;
    }
    improvement_->begin(progress.part(0.05, 1.0));
    publishLadder();
}

void Session::open(const std::string& path)
{
    cancel();
    order([this, path](const Progress& progress) {
        progress.at(0.0, "reading the take");
        begin(readTake(path), from(std::filesystem::path(path).filename().string()), progress);
    });
}

void Session::open(const VirtualOrder& wanted)
{
    cancel();
    order([this, wanted](const Progress& progress) {
        progress.at(0.0, "measuring the virtual loudspeaker");
        bench::DrawOptions options;
        options.driver = wanted.driver;
        options.noiseDb = -70.0;
        options.sampleRate = 48000.0;
        options.seconds = 4.0;
        const auto drawn = bench::draw(wanted.seed, options);
        auto take = bench::measure(drawn.speaker, drawn.setup, progress.part(0.0, 0.2));
        auto told = from("Virtual " + drawn.driver + ", seed " + std::to_string(wanted.seed));
        told.truth = titlesOf(drawn.hidden);
        begin(std::move(take), told, progress.part(0.2, 1.0));
    });
}

void Session::open(RecordingOptions recording, const std::string& source)
{
    cancel();
    order([this, recording = std::move(recording), source](const Progress& progress) {
        auto imported = importRecording(recording, progress.part(0.0, 0.1));
        auto told = from(source);
        told.remarks = std::move(imported.remarks);
        begin(std::move(imported.take), told, progress.part(0.1, 1.0));
    });
}

void Session::add(const std::string& effect)
{
    order([this, effect](const Progress& progress) {
        improvement().add(effect, progress);
        publishLadder();
    });
}

void Session::undo()
{
    order([this](const Progress&) {
        improvement().undo();
        publishLadder();
    });
}

void Session::saveReport(const std::string& path)
{
    order([this, path](const Progress& progress) {
        improvement();
        progress.at(0.0, "drawing the report");
        writeReport(findings()->file, path);
        say("Wrote " + path + ".");
    });
}

void Session::saveTake(const std::string& folder)
{
    order([this, folder](const Progress& progress) {
        const auto now = findings();
        const auto* measurement = now ? now->take->inTime() : nullptr;
        if (measurement == nullptr)
            throw Error(Error::Kind::usage, "There is no take of time signals to save.");
        progress.at(0.0, "writing the take");
        writeMeasurement(*measurement, folder);
        say("Wrote " + folder + ".");
    });
}

}  // namespace excursion::plugin
