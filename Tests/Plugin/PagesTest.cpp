// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Clicks.h"
#include "Plugin/Editor.h"
#include "Plugin/Walk.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <thread>
#include <vector>

using namespace excursion;
using plugin::Editor;
using plugin::PageName;
using plugin::Processor;

namespace {

/// Waits for the prediction on the last page.
void forecast(Editor& editor)
{
    for (int k = 0; k < 100; ++k) {
        editor.update();
        std::this_thread::sleep_for(std::chrono::milliseconds(30));
    }
}

}  // namespace

TEST_CASE("From a virtual loudspeaker to its linearization in at most five clicks", "[plugin][slow]")
{
    plugin::clicks = 0;
    Processor processor;
    processor.prepareToPlay(48000.0, 256);
    Editor editor(processor);
    CHECK(plugin::picture(editor, "measure-empty") > 1000);
    plugin::click(editor, "Measure it");
    plugin::settle(editor);
    CHECK(plugin::picture(editor, "measure") > 1000);
    const auto first = processor.session().findings();
    REQUIRE(first->file.ladder.rungs.size() == 1);
    REQUIRE(first->file.ladder.verdict == Verdict::missingEffect);
    // of which the page and a report draw the evidence of effects without a law
    CHECK(!first->file.responses.empty());
    plugin::click(editor, "Compare");
    CHECK(plugin::picture(editor, "compare") > 1000);
    plugin::click(editor, "Diagnose");
    CHECK(plugin::picture(editor, "diagnose") > 1000);
    plugin::click(editor, "Add");
    plugin::settle(editor);
    const auto second = processor.session().findings();
    REQUIRE(second->file.ladder.rungs.size() == 2);
    CHECK(second->file.ladder.verdict == Verdict::complete);
    CHECK(second->file.ladder.rungs[1].added == first->file.ladder.rungs[0].diagnosis.ranking[0].effect);
    CHECK(second->file.ladder.rungs[1].model.components.back().effect->title() == second->truth);
    CHECK(second->file.ladder.rungs[1].comparison.chiSquaredPerValue
          < 0.2 * second->file.ladder.rungs[0].comparison.chiSquaredPerValue);
    CHECK(plugin::picture(editor, "diagnose-complete") > 1000);
    plugin::click(editor, "Linearize with this model");
    CHECK(processor.model().effectIds() == second->file.ladder.model().effectIds());
    CHECK(processor.parameters().settings().mode == Mode::linearize);
    CHECK(plugin::clicks <= 5);
    forecast(editor);
    CHECK(plugin::picture(editor, "linearize") > 1000);
    plugin::click(editor, "Compare");
    CHECK(plugin::picture(editor, "compare-complete") > 1000);

    // Who has chosen what is done to the signal keeps it, and the mode that was not chosen can be taken back.
    editor.undo();
    CHECK(processor.parameters().settings().mode == Mode::bypass);
    processor.parameters().mode() = static_cast<int>(Mode::audition);
    plugin::click(editor, "Diagnose");
    plugin::click(editor, "Linearize with this model");
    CHECK(processor.parameters().settings().mode == Mode::audition);

    plugin::click(editor, "Diagnose");
    plugin::click(editor, "Take the last effect back");
    plugin::settle(editor);
    CHECK(processor.session().findings()->file.ladder.rungs.size() == 1);
    // A rung is a step of the history, whichever way it went.
    editor.undo();
    plugin::settle(editor);
    REQUIRE(processor.session().findings()->file.ladder.rungs.size() == 2);
    CHECK(processor.session().findings()->file.ladder.rungs[1].added == second->file.ladder.rungs[1].added);
    editor.redo();
    plugin::settle(editor);
    CHECK(processor.session().findings()->file.ladder.rungs.size() == 1);
    CHECK(editor.history().canUndo());
    CHECK_FALSE(editor.history().canRedo());
}

TEST_CASE("The last page shows every limit and what it does, and nothing on it is cut off or covered", "[plugin]")
{
    Processor processor;
    processor.prepareToPlay(48000.0, 480);
    Editor editor(processor);
    editor.go(PageName::linearize);
    editor.update();
    auto* const page = &editor.page(PageName::linearize);
    const auto meters = [page] { return plugin::all<plugin::Meter>(*page); };
    CHECK(meters().size() == 2);  // no limit of the power is set
    auto recipe = processor.parameters().recipe();
    recipe.mode = Mode::linearize;
    recipe.displacementLimit = 0.4;
    recipe.voltageLimit = 5.0;
    recipe.powerLimit = 20.0;
    processor.parameters().set(recipe);
    const auto play = [&processor] {
        juce::MidiBuffer midi;
        for (int block = 0; block < 100; ++block) {
            juce::AudioBuffer<float> buffer(2, 480);
            for (int n = 0; n < 480; ++n)
                for (int c = 0; c < 2; ++c)
                    buffer.setSample(
                        c, n, static_cast<float>(std::sin(2.0 * 3.14159265 * 40.0 * (480 * block + n) / 48000.0)));
            processor.processBlock(buffer, midi);
        }
    };
    play();
    editor.update();
    REQUIRE(meters().size() == 3);
    CHECK(meters()[0]->words().contains("% of what was measured, turned down by "));
    CHECK(meters()[1]->words().contains(" V, turned down by "));
    CHECK(meters()[2]->words().contains(" W"));
    // A signal that is turned down is drawn close to its limit, whatever share of the measured excursion that is.
    CHECK(meters()[0]->share() > 0.85);
    // With a margin it stops where the margin begins, and there the bars are full.
    recipe.margin = 0.3;
    processor.parameters().set(recipe);
    for (int k = 0; k < 3; ++k)  // until the louder sound of before is played out
        play();
    processor.collectMeters();
    play();
    for (int k = 0; k < 60; ++k) {  // they fall slowly, and are full again only if something is played
        if (k == 59)
            play();
        editor.update();
    }
    CHECK(meters()[0]->share() > 0.85);
    for (const auto& [width, height] : {std::pair {editor.getWidth(), editor.getHeight()}, {800, 560}}) {
        editor.setSize(width, height);
        play();
        editor.update();
        plugin::picture(editor, "linearize-limits-" + juce::String(width));
        const auto& children = page->getChildren();
        for (int a = 0; a < children.size(); ++a) {
            if (!children[a]->isVisible())
                continue;
            INFO(width << " x " << height << ", " << children[a]->getBounds().toString());
            CHECK_FALSE(children[a]->getBounds().isEmpty());
            CHECK(page->getLocalBounds().contains(children[a]->getBounds()));
            for (int b = 0; b < a; ++b)
                CHECK_FALSE(
                    (children[b]->isVisible() && children[b]->getBounds().intersects(children[a]->getBounds())));
        }
    }
    processor.prepareToPlay(1e6, 480);
    editor.update();
    CHECK(meters()[0]->words().contains("as it is"));
    processor.prepareToPlay(96000.0, 480);
    editor.update();
    CHECK_FALSE(meters()[0]->words().contains("as it is"));
}

TEST_CASE("Sentences that terminals print as well are typeset in a window", "[plugin]")
{
    const auto same = [](const char* plain, const char* typeset) {
        CHECK(plugin::typeset(plain) == plugin::words(typeset));
    };
    same("falls by 27.0 dB to -55.3 dB (-60 dB before)",
         "falls by 27.0\u202fdB to \u221255.3\u202fdB (\u221260\u202fdB before)");
    same("-3 dB, a semi-inductance from 5-10 Hz - or so", "\u22123\u202fdB, a semi-inductance from 5-10 Hz - or so");
    same("", "");
}

TEST_CASE("Work in the background is cancelled, and what cannot be read is told", "[plugin]")
{
    Processor processor;
    Editor editor(processor);
    auto& session = processor.session();
    session.open(plugin::VirtualOrder {"midbass", 3});
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    session.cancel();
    session.wait();
    CHECK(session.status().words == "Cancelled.");
    CHECK(!session.findings());
    editor.load(juce::File("/nowhere/at all"));
    session.wait();
    editor.update();
    CHECK(session.status().trouble);
    CHECK(editor.status().contains("at all"));
    session.add("stiffness");
    session.wait();
    CHECK(session.status().trouble);
    CHECK(juce::String(session.status().words).contains("open a take"));
    session.undo();
    session.saveTake(session.findings(), (std::filesystem::temp_directory_path() / "no take").string());
    session.wait();
    CHECK(session.status().trouble);
    // A window that is closed and a processor that goes away in the midst of work leave nothing behind.
    session.open(plugin::VirtualOrder {"woofer", 4});
}
