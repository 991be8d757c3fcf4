// SPDX-License-Identifier: GPL-3.0-or-later
// What is cancelled, saved or closed while a session works.
#include "Engine/Import/ReadTake.h"
#include "Plugin/Clicks.h"
#include "Plugin/Walk.h"
#include "Plugin/Editor.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <filesystem>
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
    for (int k = 0; k < 4000 && !session.findings(); ++k)
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
        session.saveTake(cancelled.path.string());
        session.cancel();
        session.wait();
        CHECK(cancelled.holdsTake());

        session.begin();
        session.saveTake(opened.path.string());
        session.open("/nowhere/at all");
        session.wait();
        CHECK(session.status().trouble);
        CHECK(opened.holdsTake());

        session.begin();
        session.saveTake(closed.path.string());
    }
    CHECK(closed.holdsTake());
    CHECK(std::get<Measurement>(readTake(closed.path)).input().samples.size() == samples);
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
    for (int k = 0; k < 2; ++k) {
        editor.undo();
        session.wait();
        editor.update();
    }
    CHECK(rungs() == 2);
    CHECK_FALSE(session.status().trouble);
}
