// SPDX-License-Identifier: GPL-3.0-or-later
// A target in the plugin: played, kept, taken back, and told on the last page before it is used.
#include "BlackBox/EveryClass.h"
#include "Engine/Predistortion/TargetFilter.h"
#include "Plugin/Played.h"
#include "Plugin/Walk.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <complex>
#include <numbers>

using namespace excursion;
using namespace excursion::test;
using plugin::Editor;
using plugin::PageName;
using plugin::Processor;

namespace {

constexpr double rate = 48000.0;

void put(Processor& processor, Mode mode, const Target& target)
{
    auto recipe = processor.parameters().recipe();
    recipe.mode = mode;
    recipe.fullScale = 100.0;
    recipe.displacementLimit = 4.0;
    recipe.voltageLimit = 100.0;
    recipe.target = target;
    processor.parameters().set(recipe);
}

/// V per V of a tone that is so soft that no law bends, once it is steady.
std::complex<double> gain(Processor& processor, double frequency)
{
    juce::MidiBuffer midi;
    constexpr int block = 480, blocks = 200;
    const double step = 2.0 * std::numbers::pi * frequency / rate;
    std::complex<double> in, out;
    for (int b = 0; b < blocks; ++b) {
        juce::AudioBuffer<double> buffer(2, block);
        for (int k = 0; k < block; ++k)
            for (int c = 0; c < 2; ++c)
                buffer.setSample(c, k, 1e-6 * std::sin(step * (block * b + k)));
        const juce::AudioBuffer<double> before(buffer);
        processor.processBlock(buffer, midi);
        if (b < blocks / 2)
            continue;
        for (int k = 0; k < block; ++k) {
            const auto turn = std::polar(1.0, -step * (block * b + k));
            in += before.getSample(1, k) * turn;
            out += buffer.getSample(1, k) * turn;
        }
    }
    return out / in * std::polar(1.0, step * processor.getLatencySamples());
}

}  // namespace

TEST_CASE("The plugin plays the target of its recipe, smoothly put in, and none in bypass", "[plugin][target]")
{
    Processor processor;
    const Target target {Target::Kind::resonance, 35.0, 0.6, 0.02};
    processor.prepareToPlay(rate, 480);
    put(processor, Mode::linearize, target);
    TargetFilter expected(OwnLinearPart(processor.model()), rate);
    expected.aim(target);
    expected.jump();
    for (const double frequency : {20.0, 40.0, 100.0, 400.0}) {
        const auto found = gain(processor, frequency), truth = expected.at(frequency);
        INFO(frequency << " Hz");
        CHECK(std::abs(found - truth) < 1e-3 * std::abs(truth));
    }
    put(processor, Mode::linearize, {});
    CHECK(std::abs(gain(processor, 40.0) - 1.0) < 1e-3);
    put(processor, Mode::bypass, target);
    gain(processor, 40.0);
    CHECK(std::abs(gain(processor, 40.0) - 1.0) < 1e-12);
}

TEST_CASE("A target is kept with the state, and is a step of the history", "[plugin][target]")
{
    Processor processor, other;
    put(processor, Mode::linearize, {Target::Kind::closedBox, 33.3, 0.55, 0.0123});
    const auto state = stateOf(processor);
    other.setStateInformation(state.getData(), static_cast<int>(state.getSize()));
    CHECK(other.parameters().recipe().target == processor.parameters().recipe().target);
    CHECK((stateOf(other) == state));

    Processor fresh;
    Editor editor(fresh);
    editor.go(PageName::linearize);
    editor.update();
    for (auto* list : plugin::all<juce::ComboBox>(editor.page(PageName::linearize)))
        if (list->getTitle() == "Target")
            list->setSelectedItemIndex(1, juce::sendNotificationSync);
    CHECK(fresh.parameters().settings().target.kind == Target::Kind::resonance);
    editor.undo();
    CHECK(fresh.parameters().settings().target.kind == Target::Kind::own);
    editor.redo();
    CHECK(fresh.parameters().settings().target.kind == Target::Kind::resonance);
}

TEST_CASE("The last page tells what a target costs, also while it is not in use, and why there is none",
          "[plugin][target]")
{
    Processor processor;
    Editor editor(processor);
    editor.go(PageName::linearize);
    auto& panel = dynamic_cast<plugin::LinearizePage&>(editor.page(PageName::linearize)).target();
    panel.choosePicture(true);
    const auto told = [&](const juce::String& wanted) {
        juce::String text;
        for (int k = 0; k < 3000; ++k) {
            editor.update();
            for (auto* label : plugin::all<juce::Label>(panel))
                if (label->getTitle() == "What the target costs")
                    text = label->getText();
            if (text.contains(wanted))
                return true;
            juce::Thread::sleep(20);
        }
        INFO(text);
        CHECK(text == wanted);
        return false;
    };
    CHECK(told("Not in use: 40.0"));
    const auto plots = plugin::all<plugin::PlotView>(panel);
    REQUIRE(plots.size() == 3);
    CHECK(plots[1]->plot().series.size() == 3);  // own, target, limit
    auto without = processor.parameters().recipe();
    without.off = processor.model().effectIds();
    processor.parameters().set(without);
    editor.update();
    CHECK(told("Not in use: 40.0"));
    CHECK(plots[1]->plot().series.size() == 3);  // the limit is that of the model as it was loaded
    without.off.clear();
    processor.parameters().set(without);
    put(processor, Mode::speaker, {Target::Kind::resonance, 30.0, 0.7, 0.02});
    CHECK(told("Not in use: 30.0"));
    put(processor, Mode::linearize, {Target::Kind::resonance, 30.0, 0.7, 0.02});
    CHECK(told("In use: 30.0"));
    put(processor, Mode::linearize, {Target::Kind::resonance, 5000.0, 0.7, 0.02});
    CHECK(told("out of reach"));
    // What tells the current does not tell the cone.
    const auto classes = everyClass();
    const auto box = plugin::loadedBox(classes[1], "a test");
    REQUIRE(box->played.box.output == "current");
    processor.setModel(box);
    put(processor, Mode::linearize, {Target::Kind::resonance, 30.0, 0.7, 0.02});
    CHECK(told(box->played.rehearsal ? "cannot be given another resonance" : "not turned around has no target"));
}

TEST_CASE("A flat band and the response of a file are targets of the last page, told before they are used, kept with "
          "the state",
          "[plugin][target]")
{
    Processor processor, other;
    Editor editor(processor);
    editor.go(PageName::linearize);
    auto& panel = dynamic_cast<plugin::LinearizePage&>(editor.page(PageName::linearize)).target();
    Target target;
    target.kind = Target::Kind::flat;
    target.low = 60.0;
    target.high = 400.0;
    target.curve[12] = 3.25;
    target.curve[13] = Target::notGiven;
    put(processor, Mode::speaker, target);
    panel.choosePicture(true);
    juce::String text;
    for (int k = 0; k < 3000 && !text.contains("equalized"); ++k) {
        editor.update();
        for (auto* label : plugin::all<juce::Label>(panel))
            if (label->getTitle() == "What the target costs")
                text = label->getText();
        juce::Thread::sleep(20);
    }
    INFO(text);
    CHECK(text.startsWith("Not in use: equalized"));
    const auto plots = plugin::all<plugin::PlotView>(panel);
    REQUIRE(plots.size() == 3);
    const auto& curve = plots.front()->plot().series[1];  // the target
    double least = 1e9, most = -1e9;
    for (std::size_t k = 0; k < curve.x.size(); ++k)
        if (curve.x[k] > target.low && curve.x[k] < target.high) {
            least = std::min(least, curve.y[k]);
            most = std::max(most, curve.y[k]);
        }
    CHECK(most - least < 1.2);
    const auto state = stateOf(processor);
    other.setStateInformation(state.getData(), static_cast<int>(state.getSize()));
    CHECK(other.parameters().recipe().target == target);
    CHECK((stateOf(other) == state));

    processor.prepareToPlay(rate, 480);
    put(processor, Mode::linearize, target);
    TargetFilter expected(OwnLinearPart(processor.model()), rate);
    expected.aim(target);
    expected.jump();
    for (const double frequency : {60.0, 100.0, 400.0}) {
        const auto found = gain(processor, frequency), truth = expected.at(frequency);
        INFO(frequency << " Hz");
        CHECK(std::abs(found - truth) < 2e-3 * std::abs(truth));
    }
}

TEST_CASE("A curve that is loaded or dropped on its button is a step of the history; what is none changes nothing",
          "[plugin][target]")
{
    Processor processor;
    Editor editor(processor);
    editor.go(PageName::linearize);
    auto& panel = dynamic_cast<plugin::LinearizePage&>(editor.page(PageName::linearize)).target();
    const auto folder = juce::File::createTempFile("curves");
    REQUIRE(folder.createDirectory().wasOk());
    const auto frd = folder.getChildFile("house.frd"), nonsense = folder.getChildFile("nonsense.frd");
    REQUIRE(frd.replaceWithText("20 6\n100 3\n1000 0\n20000 -6\n"));
    REQUIRE(nonsense.replaceWithText("no numbers here\n"));
    const juce::StringArray dropped {frd.getFullPathName()};
    // While no button asks for a curve the file is a take, of which the window knows.
    CHECK_FALSE(panel.isInterestedInFileDrag(dropped));
    auto target = processor.parameters().recipe().target;
    target.kind = Target::Kind::bands;
    put(processor, Mode::bypass, target);
    editor.update();
    editor.resized();
    CHECK(panel.isInterestedInFileDrag(dropped));
    CHECK_FALSE(panel.isInterestedInFileDrag({folder.getChildFile("model.json").getFullPathName()}));
    const auto curve = [&] { return processor.parameters().settings().target.curve; };
    const auto before = curve();
    panel.filesDropped(dropped, 0, 0);
    const auto now = curve();
    CHECK(now != before);
    CHECK(editor.status().contains("house.frd"));
    CHECK(editor.history().nextBack() == "Target curve");
    editor.undo();
    CHECK(curve() == before);
    editor.redo();
    CHECK(curve() == now);
    editor.undo();
    REQUIRE_FALSE(editor.history().canUndo());
    panel.use(nonsense);
    CHECK(curve() == before);
    CHECK(editor.status().contains("nonsense.frd"));
    CHECK_FALSE(editor.history().canUndo());
    folder.deleteRecursively();
}
