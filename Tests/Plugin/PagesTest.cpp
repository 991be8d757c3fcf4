// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Editor.h"
#include "Plugin/VirtualDevice.h"
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

/// A picture of the window, kept to be looked at; the number of its pixels (every fifth) that are not background.
int picture(Editor& editor, const juce::String& name)
{
    const auto image = editor.createComponentSnapshot(editor.getLocalBounds());
    int drawn = 0;
    for (int x = 0; x < image.getWidth(); x += 5)
        for (int y = 0; y < image.getHeight(); y += 5)
            drawn += image.getPixelAt(x, y) != image.getPixelAt(0, 0) ? 1 : 0;
    const juce::File file(juce::String(EXCURSION_SCREENSHOTS) + "/" + name + ".png");
    file.getParentDirectory().createDirectory();
    file.deleteFile();
    juce::FileOutputStream stream(file);
    CHECK(juce::PNGImageFormat().writeImageToStream(image, stream));
    return drawn;
}

template <class Component>
Component* find(juce::Component& parent, const juce::String& text)
{
    for (auto* child : parent.getChildren()) {
        if (auto* match = dynamic_cast<Component*>(child);
            match != nullptr && match->getButtonText() == text && match->isVisible())
            return match;
        if (child->isVisible())
            if (auto* match = find<Component>(*child, text))
                return match;
    }
    return nullptr;
}

int clicks = 0;

/// As a person does: only what is seen and enabled can be clicked.
void click(Editor& editor, const juce::String& text)
{
    auto* button = find<juce::TextButton>(editor, text);
    INFO(text);
    REQUIRE(button != nullptr);
    REQUIRE(button->isEnabled());
    ++clicks;
    button->onClick();
    editor.update();
}

void settle(Editor& editor)
{
    editor.processor().session().wait();
    editor.update();
    INFO(editor.status());
    REQUIRE(!editor.processor().session().status().trouble);
}

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
    clicks = 0;
    Processor processor;
    processor.prepareToPlay(48000.0, 256);
    Editor editor(processor);
    CHECK(picture(editor, "measure-empty") > 1000);
    click(editor, "Measure it");
    settle(editor);
    CHECK(picture(editor, "measure") > 1000);
    const auto first = processor.session().findings();
    REQUIRE(first->file.ladder.rungs.size() == 1);
    REQUIRE(first->file.ladder.verdict == Verdict::missingEffect);
    // of which the page and a report draw the evidence of effects without a law
    CHECK(!first->file.responses.empty());
    click(editor, "Compare");
    CHECK(picture(editor, "compare") > 1000);
    click(editor, "Diagnose");
    CHECK(picture(editor, "diagnose") > 1000);
    click(editor, "Add");
    settle(editor);
    const auto second = processor.session().findings();
    REQUIRE(second->file.ladder.rungs.size() == 2);
    CHECK(second->file.ladder.verdict == Verdict::complete);
    CHECK(second->file.ladder.rungs[1].added == first->file.ladder.rungs[0].diagnosis.ranking[0].effect);
    CHECK(second->file.ladder.rungs[1].model.components.back().effect->title() == second->truth);
    CHECK(second->file.ladder.rungs[1].comparison.chiSquaredPerValue
          < 0.2 * second->file.ladder.rungs[0].comparison.chiSquaredPerValue);
    CHECK(picture(editor, "diagnose-complete") > 1000);
    click(editor, "Linearize with this model");
    CHECK(processor.model().effectIds() == second->file.ladder.model().effectIds());
    CHECK(processor.parameters().settings().mode == Mode::linearize);
    CHECK(clicks <= 5);
    forecast(editor);
    CHECK(picture(editor, "linearize") > 1000);
    click(editor, "Compare");
    CHECK(picture(editor, "compare-complete") > 1000);

    // Who has chosen what is done to the signal keeps it, and the mode that was not chosen can be taken back.
    editor.undo();
    CHECK(processor.parameters().settings().mode == Mode::bypass);
    processor.parameters().mode() = static_cast<int>(Mode::audition);
    click(editor, "Diagnose");
    click(editor, "Linearize with this model");
    CHECK(processor.parameters().settings().mode == Mode::audition);

    click(editor, "Diagnose");
    click(editor, "Take the last effect back");
    settle(editor);
    CHECK(processor.session().findings()->file.ladder.rungs.size() == 1);
    // A rung is a step of the history, whichever way it went.
    editor.undo();
    settle(editor);
    REQUIRE(processor.session().findings()->file.ladder.rungs.size() == 2);
    CHECK(processor.session().findings()->file.ladder.rungs[1].added == second->file.ladder.rungs[1].added);
    editor.redo();
    settle(editor);
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
        picture(editor, "linearize-limits-" + juce::String(width));
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
    session.saveTake((std::filesystem::temp_directory_path() / "no take").string());
    session.wait();
    CHECK(session.status().trouble);
    // A window that is closed and a processor that goes away in the midst of work leave nothing behind.
    session.open(plugin::VirtualOrder {"woofer", 4});
}

TEST_CASE("A loudspeaker on an audio device is measured, and its hidden effect is found", "[plugin][slow]")
{
    juce::AudioDeviceManager devices;
    devices.addAudioDeviceType(std::make_unique<plugin::VirtualDeviceType>());
    devices.setCurrentAudioDeviceType("Virtual", true);
    juce::AudioDeviceManager::AudioDeviceSetup setup;
    setup.inputDeviceName = setup.outputDeviceName = "Virtual loudspeaker";
    setup.sampleRate = 48000.0;
    setup.bufferSize = 256;
    REQUIRE(devices.setAudioDeviceSetup(setup, true).isEmpty());

    Processor processor;
    processor.prepareToPlay(48000.0, 256);
    Editor editor(processor, &devices);
    auto& panel = *editor.measure().measuring();
    panel.setRole(2, Quantity::displacement, 8e-3);
    panel.setBand(20.0, 2000.0);
    panel.setLevels("0.5 1.5 3.5");
    click(editor, "Start measuring");
    REQUIRE(panel.running());
    CHECK(processor.isSuspended());
    picture(editor, "measuring");
    editor.go(PageName::compare);  // it goes on, whatever page is seen
    for (int k = 0; k < 2000 && panel.running(); ++k) {
        editor.update();
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    REQUIRE(!panel.running());
    CHECK(!processor.isSuspended());
    settle(editor);
    picture(editor, "measured");
    const auto findings = processor.session().findings();
    REQUIRE(findings);
    for (const auto& problem : findings->report.problems)
        UNSCOPED_INFO(problem.sentence);
    REQUIRE(findings->report.fitForUse());
    REQUIRE(!findings->file.ladder.rungs.empty());
    CHECK(findings->file.ladder.verdict == Verdict::missingEffect);
    CHECK(findings->file.ladder.rungs[0].diagnosis.ranking[0].effect == "stiffness");

    SECTION("stopped half-way, nothing is left and the processor plays on")
    {
        editor.go(PageName::measure);
        click(editor, "Start measuring");
        click(editor, "Stop");
        CHECK(!panel.running());
        CHECK(!processor.isSuspended());
    }
    SECTION("a channel is played where it is among those that are open")
    {
        const auto first = processor.session().findings();
        struct Outputs {
            Outputs() { plugin::VirtualDevice::firstOutput = 2; }
            ~Outputs() { plugin::VirtualDevice::firstOutput = 0; }
        } const outputs;
        editor.go(PageName::measure);
        panel.setOutput(3);
        click(editor, "Start measuring");
        CHECK(panel.running());
        for (int k = 0; k < 2000 && panel.running(); ++k) {
            editor.update();
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        REQUIRE(!panel.running());
        settle(editor);
        REQUIRE(processor.session().findings() != first);
        CHECK(processor.session().findings()->report.fitForUse());
    }
    SECTION("a device that is gone without a word ends the measurement")
    {
        editor.go(PageName::measure);
        click(editor, "Start measuring");
        REQUIRE(panel.running());
        plugin::VirtualDevice::gone = true;
        for (int k = 0; k < 400 && panel.running(); ++k) {
            editor.update();
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        plugin::VirtualDevice::gone = false;
        CHECK(!panel.running());
        CHECK(!processor.isSuspended());
        CHECK(editor.status().contains("no sound any more"));
    }
    SECTION("a take is not written over another")
    {
        const auto folder = juce::File::createTempFile("take");
        REQUIRE(folder.createDirectory());
        REQUIRE(folder.getChildFile("measurement.json").replaceWithText("mine"));
        editor.measure().save(folder);
        editor.update();
        CHECK(editor.status().contains("holds a take already"));
        processor.session().wait();
        CHECK(folder.getChildFile("measurement.json").loadFileAsString() == "mine");
        folder.deleteRecursively();
    }
    SECTION("what makes no sense is refused in a sentence")
    {
        editor.go(PageName::measure);
        panel.setLevels("0.5 loud");
        click(editor, "Start measuring");
        CHECK(!panel.running());
        CHECK(editor.status().contains("loud"));
        panel.setLevels("9");
        click(editor, "Start measuring");
        CHECK(!panel.running());
        panel.setLevels("0.5 1,5");
        click(editor, "Start measuring");
        CHECK(!panel.running());
        CHECK(editor.status().contains("1,5"));
        panel.setOutput(5);
        panel.setLevels("0.5 1");
        click(editor, "Start measuring");
        CHECK(!panel.running());
        CHECK(editor.status().contains("Output 5 is not open"));
        panel.setOutput(1);
        panel.setLevels("1");
        panel.setRole(2, Quantity::current, 1.0);
        click(editor, "Start measuring");
        CHECK(!panel.running());
        CHECK(editor.status().contains("current"));
    }
}
