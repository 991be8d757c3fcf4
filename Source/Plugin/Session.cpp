// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Session.h"

#include "Bench/Draw.h"
#include "Engine/Error.h"
#include "Engine/Import/ImportRecording.h"
#include "Engine/Import/ReadTake.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Take/TakeFile.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <utility>

namespace excursion::plugin {
namespace {

constexpr auto readingWords = "reading the take";
constexpr auto readingPatience = std::chrono::seconds(5);  // with files that are being read when a session ends

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

/// What went wrong, in a sentence.
std::string sentenceOf(const std::exception_ptr& thrown)
{
    try {
        std::rethrow_exception(thrown);
    } catch (const Error& error) {
        return error.kind() == Error::Kind::cancelled ? "Cancelled." : error.what();
    } catch (const std::exception& error) {
        return std::string("This went wrong: ") + error.what() + ".";
    }
}

}  // namespace

Session::Opened Session::openFile(const std::string& path)
{
    if (const auto header = headerOf(path); !header.empty()) {
        auto own = readOwnTake(header);
        return {std::move(own.take), std::move(own.sweep)};
    }
    return {readTake(path), std::nullopt};
}

Session::Session(Open open) : open_(std::move(open)), thread_([this](const std::stop_token& stop) { run(stop); })
{
    inbox_->session = this;
}

Session::~Session()
{
    {
        const std::lock_guard lock(inbox_->mutex);
        inbox_->session = nullptr;
    }
    cancel();
    thread_.request_stop();
    changed_.notify_all();
    // Whoever still reads runs code that may be unloaded after this: only a file that hangs is left behind.
    std::unique_lock lock(inbox_->mutex);
    inbox_->changed.wait_for(lock, readingPatience, [this] { return inbox_->readers == 0; });
}

void Session::order(Work work, bool saves)
{
    const std::lock_guard lock(mutex_);
    orders_.push_back({std::move(work), saves});
    status_.busy = true;
    changed_.notify_all();
}

void Session::cancel()
{
    const std::lock_guard lock(mutex_);
    if (!working_ && std::erase_if(orders_, [](const Order& waiting) { return !waiting.ready(); }) > 0)
        status_.words = "Cancelled.";
    std::erase_if(orders_, [](const Order& waiting) { return !waiting.saves; });
    shape_.reset();
    stop_.request_stop();
    status_.busy = working_ || !orders_.empty();
    changed_.notify_all();
}

/// With the mutex held: the order to be carried out now. Saves do not wait for a file that is being read; all others
/// keep their order.
std::vector<Session::Order>::iterator Session::next()
{
    if (orders_.empty() || orders_.front().ready())
        return orders_.begin();
    return std::find_if(orders_.begin(), orders_.end(), [](const Order& waiting) { return waiting.saves; });
}

void Session::run(const std::stop_token& stop)
{
    std::unique_lock lock(mutex_);
    for (;;) {
        if (!changed_.wait(lock, stop, [this] { return next() != orders_.end(); }))
            return;
        const auto place = next();
        const auto [work, saves, file] = std::move(*place);
        orders_.erase(place);
        stop_ = std::stop_source();
        working_ = true;
        status_.fraction = 0.0;
        status_.trouble = false;
        Progress progress;
        if (!saves)
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
        } catch (const std::exception&) {
            trouble = sentenceOf(std::current_exception());
        }
        lock.lock();
        if (!trouble.empty()) {
            status_.words = trouble;
            status_.trouble = true;
            if (saves)
                fail(trouble);
        }
        working_ = false;
        status_.busy = !orders_.empty();
        if (status_.busy && next() == orders_.end()) {
            status_.words = readingWords;
            status_.fraction = 0.0;
        }
        changed_.notify_all();
    }
}

/// With the mutex held: beside the work that goes on.
void Session::fail(const std::string& trouble)
{
    status_.failure = trouble;
    ++status_.failures;
}

void Session::read(const std::shared_ptr<Inbox>& inbox, const ReadingPointer& reading, const Open& open)
{
    try {
        reading->opened = open(reading->path);
    } catch (const std::exception&) {
        reading->thrown = std::current_exception();
    }
    const std::lock_guard lock(inbox->mutex);
    if (inbox->session != nullptr)
        inbox->session->came(reading);
    --inbox->readers;
    inbox->changed.notify_all();
}

/// A file has been read, or cannot be. Its order waits, or was cancelled.
void Session::came(const ReadingPointer& reading)
{
    const std::lock_guard lock(mutex_);
    reading->done = true;
    const auto place = std::find_if(orders_.begin(), orders_.end(),
                                    [&](const Order& waiting) { return waiting.reading == reading; });
    if (place != orders_.end() && reading->thrown) {
        fail(sentenceOf(reading->thrown));
        orders_.erase(place);
        status_.busy = working_ || !orders_.empty();
        if (!status_.busy) {
            status_.words = status_.failure;
            status_.trouble = true;
        }
    } else if (place != orders_.end()) {
        orders_.erase(std::remove_if(orders_.begin(), place, [](const Order& waiting) { return !waiting.saves; }),
                      place);
        shape_.reset();
        stop_.request_stop();
    }
    changed_.notify_all();
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

void Session::take(PreparedTake take, const Findings& told, const Progress& progress,
                   const std::shared_ptr<const RecordingOptions>& of)
{
    Improvement work(take, {}, progress.part(0.0, 0.05));
    auto fresh = std::make_shared<Findings>(told);
    fresh->report = take.report();
    fresh->file = makeLadderFile(work.ladder(), take, told.source);
    fresh->take = std::make_shared<const PreparedTake>(std::move(take));
    put({});  // those of another take
    {
        const std::lock_guard lock(mutex_);
        // what the check refuses may have to be imported in another way, as with a latency
        if (of && recording_ == of && fresh->report.fitForUse())
            recording_ = nullptr;
    }
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
    const auto reading = std::make_shared<Reading>();
    reading->path = path;
    const auto work = [this, reading](const Progress& progress) {
        auto told = from(std::filesystem::path(reading->path).filename().string());
        auto opened = *std::exchange(reading->opened, std::nullopt);
        told.sweep = std::move(opened.second);
        take(std::move(opened.first), told, progress);
    };
    {
        const std::lock_guard lock(mutex_);
        if (!status_.busy) {
            status_.words = readingWords;
            status_.fraction = 0.0;
            status_.trouble = false;
        }
        orders_.push_back({work, false, reading});
        status_.busy = true;
    }
    {
        const std::lock_guard lock(inbox_->mutex);
        ++inbox_->readers;
    }
    try {
        std::thread(read, inbox_, reading, open_).detach();
    } catch (const std::system_error&) {  // there is no thread to be had
        read(inbox_, reading, open_);
    }
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
        auto measured = bench::measure(drawn.speaker, drawn.setup, progress.part(0.0, 0.2));
        auto told = from("Virtual " + drawn.driver + ", seed " + std::to_string(wanted.seed));
        told.truth = titlesOf(drawn.hidden);
        take(std::move(measured), told, progress.part(0.2, 1.0));
    });
}

void Session::keep(RecordingOptions recorded, const std::string& source, std::vector<std::string> remarks,
                   double fullScale)
{
    const std::lock_guard lock(mutex_);
    recording_ = std::make_shared<const RecordingOptions>(std::move(recorded));
    recorded_ = from(source);
    recorded_.measured = true;
    recorded_.remarks = std::move(remarks);
    recorded_.fullScale = fullScale;
    keeps_ = true;
}

bool Session::keeps() const
{
    const std::lock_guard lock(mutex_);
    return keeps_;
}

void Session::openKept()
{
    std::shared_ptr<const RecordingOptions> recording;
    Findings told;
    {
        const std::lock_guard lock(mutex_);
        if (!std::exchange(keeps_, false))
            return;
        recording = recording_;
        told = recorded_;
    }
    cancel();
    order([this, recording, told](const Progress& progress) {
        try {
            auto imported = importRecording(*recording, progress.part(0.0, 0.1));
            auto all = told;
            all.remarks.insert(all.remarks.end(), imported.remarks.begin(), imported.remarks.end());
            take(std::move(imported.take), all, progress.part(0.1, 1.0), recording);
        } catch (const Error& error) {
            if (error.kind() == Error::Kind::cancelled || recordingWithoutTake() != recording)
                throw;
            throw Error(error.kind(), std::string(error.what()) + " Save the recording to look into it.");
        }
    });
}

void Session::begin()
{
    order([this](const Progress& progress) {
        if (!improvement_ || !improvement_->take().report().fitForUse())
            throw Error(Error::Kind::usage, "There is no take that is fit for use: open one first.");
        improvement_->begin(progress);
        publishLadder();
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

}  // namespace excursion::plugin
