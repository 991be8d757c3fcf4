// SPDX-License-Identifier: GPL-3.0-or-later
// What is cancelled, saved or closed while a session works.
#include "Engine/Import/ReadTake.h"
#include "Plugin/Clicks.h"
#include "Plugin/Walk.h"
#include "Plugin/Editor.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <future>
#include <thread>

using namespace excursion;
using plugin::Editor;
using plugin::PageName;
using plugin::Processor;
using plugin::Session;
using plugin::VirtualOrder;

namespace {

/// A name of a folder that is not there.
struct NewFolder {
    const std::filesystem::path path = juce::File::createTempFile("session").getFullPathName().toStdString();
    NewFolder() = default;
    ~NewFolder() { std::filesystem::remove_all(path); }
    NewFolder(const NewFolder&) = delete;
    NewFolder& operator=(const NewFolder&) = delete;
    bool holdsTake() const { return std::filesystem::exists(path / "measurement.json"); }
};

/// Until the take has been read, before its first model is there.
void waitForTake(const Session& session)
{
    for (int k = 0; k < 60000 && !session.findings(); ++k)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    REQUIRE(session.findings());
    REQUIRE(session.findings()->file.ladder.rungs.empty());
}

}  // namespace

TEST_CASE("What is to be saved is saved, whatever is cancelled, opened or closed meanwhile", "[plugin]")
{
    NewFolder cancelled, opened, closed;
    std::size_t samples = 0;
    {
        Session session;
        session.open(VirtualOrder {"midbass", 3});
        waitForTake(session);  // the model is being fitted
        samples = session.findings()->take->inTime()->input().samples.size();
        session.saveTake(session.findings(), cancelled.path.string());
        session.cancel();
        session.wait();
        CHECK(cancelled.holdsTake());

        session.begin();
        session.saveTake(session.findings(), opened.path.string());
        session.open("/nowhere/at all");
        session.wait();
        // What cannot be opened stops nothing: the first model was fitted.
        CHECK(session.status().failures == 1);
        CHECK(juce::String(session.status().failure).contains("at all"));
        CHECK(session.findings()->file.ladder.rungs.size() == 1);
        CHECK(opened.holdsTake());

        session.begin();
        session.open(opened.path.string());
        const auto path = opened.path;
        for (int k = 0; k < 60000 && session.findings()->source != path.filename().string(); ++k)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        CHECK(session.findings()->source == path.filename().string());
        CHECK(session.findings()->file.ladder.rungs.empty());  // what was fitted is not of it
        session.cancel();
        session.wait();

        session.begin();
        session.saveTake(session.findings(), closed.path.string());
    }
    CHECK(closed.holdsTake());
    CHECK(std::get<Measurement>(readTake(closed.path)).input().samples.size() == samples);
}

TEST_CASE("A file that never comes holds up neither the next one nor a save, and a session ends without it", "[plugin]")
{
    NewFolder saved, again;
    std::promise<void> comes;
    const auto left = std::make_shared<std::atomic<int>>(3);  // threads that wait for it
    const auto open = [came = comes.get_future().share(), left](const std::string& path) {
        if (path != "a disk that is gone")
            return Session::openFile(path);
        came.wait();
        --*left;
        return Session::Opened();
    };
    auto closed = std::chrono::steady_clock::now();
    {
        Session session(open);
        session.open(VirtualOrder {"midbass", 3});
        waitForTake(session);
        session.cancel();
        session.saveTake(session.findings(), saved.path.string());
        session.wait();

        session.open("a disk that is gone");
        session.saveTake(session.findings(), again.path.string());
        for (int k = 0; k < 60000 && !again.holdsTake(); ++k)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        CHECK(again.holdsTake());
        CHECK(session.status().busy);
        session.cancel();
        session.wait();
        CHECK(!session.status().busy);
        CHECK(session.status().failures == 0);

        session.open("a disk that is gone");
        session.open(saved.path.string());
        const auto name = saved.path.filename().string();
        for (int k = 0; k < 60000 && session.findings()->source != name; ++k)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        CHECK(session.findings()->source == name);
        session.cancel();
        session.open("a disk that is gone");
        closed = std::chrono::steady_clock::now();
    }
    CHECK(std::chrono::steady_clock::now() - closed < std::chrono::seconds(20));
    comes.set_value();
    while (*left > 0)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

TEST_CASE("A file that cannot be read is a failure, whatever is under way", "[plugin]")
{
    Session session;
    session.open("/nowhere/at all");
    session.wait();
    CHECK(session.status().failures == 1);
    CHECK(session.status().trouble);
    CHECK(session.status().words == session.status().failure);
    session.open(VirtualOrder {"midbass", 3});
    session.open("/nowhere/at all");
    waitForTake(session);
    for (int k = 0; k < 60000 && session.status().failures < 2; ++k)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    CHECK(session.status().failures == 2);
    CHECK(!session.status().trouble);
    CHECK(session.status().busy);
    session.cancel();
    session.wait();
}

TEST_CASE("A take of sweeps is saved with its sweeps, and the take that was there when Save was pressed", "[plugin]")
{
    SweepExcitation sweeps;
    sweeps.bandLow = 50.0;
    sweeps.bandHigh = 3000.0;
    sweeps.seconds = 0.5;
    sweeps.silence = 0.1;
    sweeps.levels = {0.5, 2.0};
    SweepTake written {planSweep(sweeps, 16000.0), sweeps};
    auto current = written.take.channels.front();
    current.quantity = Quantity::current;
    current.unit = "A";
    for (auto& sample : current.samples)
        sample *= 0.25;
    written.take.channels.push_back(current);
    NewFolder from, to;
    writeSweepTake(written, from.path);
    Session session;
    session.open(from.path.string());
    for (int k = 0; k < 60000 && !session.findings(); ++k)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    session.cancel();
    session.wait();
    const auto then = session.findings();
    REQUIRE(then);
    session.open(VirtualOrder {"midbass", 3});
    for (int k = 0; k < 60000 && session.findings() == then; ++k)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    session.cancel();
    session.saveTake(then, to.path.string());
    session.wait();
    const auto read = readSweepTake(to.path);
    CHECK(read.take.length() == written.take.length());
    REQUIRE(read.sweep);
    CHECK(read.sweep->levels == sweeps.levels);
    CHECK(read.sweep->bandHigh == sweeps.bandHigh);
}

TEST_CASE("A first model that was cancelled is fitted when it is asked for", "[plugin]")
{
    Processor processor;
    Editor editor(processor);
    auto& session = processor.session();
    session.open(VirtualOrder {"midbass", 3});
    waitForTake(session);
    session.cancel();
    session.wait();
    editor.go(PageName::diagnose);
    editor.update();
    const auto says = [&editor](const juce::String& text) {
        bool found = false;
        plugin::walk(editor, [&](juce::Component& one) {
            if (const auto* label = dynamic_cast<juce::Label*>(&one))
                found = found || label->getText().contains(text);
        });
        return found;
    };
    CHECK(says("There is no model of this take yet."));
    plugin::picture(editor, "diagnose-without-model");
    plugin::click(editor, "Fit the first model");
    CHECK(says("The first model is being fitted."));
    plugin::settle(editor);
    CHECK(session.findings()->file.ladder.rungs.size() == 1);
    CHECK_FALSE(says("There is no model of this take yet."));
    CHECK(plugin::find<juce::TextButton>(editor, "Fit the first model") == nullptr);
}

TEST_CASE("An effect whose adding was cancelled is still there to be done again, and nothing else is taken back",
          "[plugin][slow]")
{
    Processor processor;
    Editor editor(processor);
    auto& session = processor.session();
    session.open(VirtualOrder {"midbass", 3});
    session.wait();
    editor.update();
    editor.go(PageName::diagnose);
    editor.update();
    const auto rungs = [&session] { return session.findings()->file.ladder.rungs.size(); };
    REQUIRE(rungs() == 1);
    plugin::click(editor, "Add");
    plugin::settle(editor);
    REQUIRE(rungs() == 2);
    editor.undo();
    plugin::settle(editor);
    REQUIRE(rungs() == 1);
    CHECK(editor.history().canRedo());
    editor.redo();
    session.cancel();
    session.wait();
    editor.update();
    REQUIRE(rungs() == 1);
    CHECK(editor.history().canRedo());
    CHECK_FALSE(editor.history().canUndo());

    // The same of a second effect, with a step of another kind in between: what was cancelled is forgotten, and the
    // effect that is there stays.
    editor.redo();
    plugin::settle(editor);
    session.add("force-factor");
    plugin::settle(editor);
    REQUIRE(rungs() == 3);
    editor.undo();
    plugin::settle(editor);
    REQUIRE(rungs() == 2);
    editor.redo();
    editor.history().did(
        "Something else", [] {}, [] {});
    session.cancel();
    session.wait();
    editor.update();
    REQUIRE(rungs() == 2);
    const auto said = session.status().words;  // that it was cancelled, where it had begun
    for (int k = 0; k < 2; ++k) {
        editor.undo();
        session.wait();
        editor.update();
    }
    CHECK(rungs() == 2);
    CHECK(session.status().words == said);  // neither step has asked for anything, which would fail
}
