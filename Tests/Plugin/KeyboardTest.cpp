// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Walk.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <typeinfo>

using namespace excursion;
using plugin::Editor;
using plugin::PageName;
using plugin::Processor;

namespace {

/// What a person operates.
bool isControl(juce::Component& one)
{
    return dynamic_cast<juce::Button*>(&one) != nullptr || dynamic_cast<juce::Slider*>(&one) != nullptr
           || dynamic_cast<juce::ComboBox*>(&one) != nullptr || dynamic_cast<juce::TextEditor*>(&one) != nullptr
           || dynamic_cast<plugin::Card*>(&one) != nullptr || dynamic_cast<plugin::PlotView*>(&one) != nullptr;
}

/// A part of another control, which does what it does by keys: the arrows of a slider, the menu of a plot.
bool belongsToControl(juce::Component& one)
{
    for (auto* above = one.getParentComponent(); above != nullptr; above = above->getParentComponent())
        if (dynamic_cast<juce::Slider*>(above) != nullptr || dynamic_cast<juce::ComboBox*>(above) != nullptr
            || dynamic_cast<plugin::PlotView*>(above) != nullptr || dynamic_cast<juce::ScrollBar*>(above) != nullptr)
            return true;
    return dynamic_cast<juce::ScrollBar*>(&one) != nullptr;
}

juce::KeyPress ctrl(int code, bool shift = false)
{
    return {code, juce::ModifierKeys::commandModifier | (shift ? juce::ModifierKeys::shiftModifier : 0), 0};
}

}  // namespace

TEST_CASE("Tab reaches every control, in the order in which it is read, and each has a name for a screen reader",
          "[plugin]")
{
    juce::AudioDeviceManager devices;
    Processor processor;
    Editor editor(processor, &devices);
    editor.show(plugin::syntheticFindings(2));
    processor.session().put(plugin::identifiedForPictures(plugin::ModelTime::fractional));
    for (const auto name :
         {PageName::measure, PageName::compare, PageName::diagnose, PageName::identify, PageName::linearize}) {
        editor.go(name);
        editor.update();
        juce::KeyboardFocusTraverser traverser;
        const auto reached = traverser.getAllComponents(&editor);
        int controls = 0;
        plugin::walk(editor.body(), [&](juce::Component& one) {
            if (!isControl(one) || belongsToControl(one))
                return;
            ++controls;
            const auto* button = dynamic_cast<juce::TextButton*>(&one);
            INFO("page " << static_cast<int>(name) << ", " << typeid(one).name() << " \"" << one.getTitle() << "\" \""
                         << (button != nullptr ? button->getButtonText() : juce::String()) << "\" at "
                         << one.getBounds().toString());
            CHECK((one.getTitle().isNotEmpty() || (button != nullptr && button->getButtonText().length() > 1)));
            auto* view = dynamic_cast<plugin::PlotView*>(&one);
            if (one.isEnabled() && (view == nullptr || !view->plot().series.empty()))
                CHECK(std::find(reached.begin(), reached.end(), &one) != reached.end());
        });
        CHECK(controls > 12);
        // Nothing else takes the focus on the way but what scrolls.
        for (auto* one : reached) {
            INFO("page " << static_cast<int>(name) << ", " << typeid(*one).name());
            CHECK((isControl(*one) || dynamic_cast<juce::Viewport*>(one) != nullptr));
        }
        REQUIRE(reached.size() > 4);
        for (std::size_t k = 0; k < 5; ++k)  // the pages come first
            CHECK(dynamic_cast<juce::TextButton*>(reached[k]) != nullptr);
    }
}

TEST_CASE("The ring surrounds what has the focus, and nothing else", "[plugin]")
{
    Processor processor;
    Editor editor(processor);
    editor.go(PageName::linearize);
    editor.update();
    const auto dials = plugin::all<plugin::Dial>(editor.body());
    REQUIRE(!dials.empty());
    auto& ring = editor.ring();
    ring.surround(dials.front());
    CHECK(ring.isVisible());
    CHECK(ring.getBounds().contains(editor.getLocalArea(dials.front(), dials.front()->getLocalBounds())));
    const auto image = editor.createComponentSnapshot(editor.getLocalBounds());
    CHECK(image.getPixelAt(ring.getX() + 1, ring.getBounds().getCentreY()) == plugin::look::palette().accent);
    editor.setScale(1.5);
    editor.setSize(1500, 1000);
    ring.follow();
    CHECK(ring.getBounds().contains(editor.getLocalArea(dials.front(), dials.front()->getLocalBounds())));
    editor.go(PageName::measure);
    ring.follow();
    CHECK_FALSE(ring.isVisible());
    ring.surround(nullptr);
    CHECK_FALSE(ring.isVisible());
    plugin::preferencesFile().deleteFile();
}

TEST_CASE("The mouse wheel leaves a dial alone that has no focus", "[plugin]")
{
    Processor processor;
    auto& number = *processor.parameters().numbers().front();
    plugin::NumberDial dial(number);
    auto& slider = dial.slider();
    slider.setSize(300, 24);
    const double before = number.get();
    const auto turn = [&slider](int modifiers) {
        const auto source = juce::Desktop::getInstance().getMainMouseSource();
        const auto now = juce::Time::getCurrentTime();
        const juce::MouseEvent event(source, {50.0f, 12.0f}, juce::ModifierKeys(modifiers), 0.0f, 0.0f, 0.0f, 0.0f,
                                     0.0f, &slider, &slider, now, {50.0f, 12.0f}, now, 0, false);
        const juce::MouseWheelDetails wheel {0.0f, 0.5f, false, false, false};
        slider.mouseWheelMove(event, wheel);
    };
    turn(0);
    CHECK(number.get() == before);
    turn(juce::ModifierKeys::ctrlModifier);
    CHECK(number.get() != before);
}

TEST_CASE("The arrow keys move a dial by steps, to its ends and back to where it was at first", "[plugin]")
{
    Processor processor;
    for (auto* number : processor.parameters().numbers()) {
        plugin::NumberDial dial(*number);
        auto& slider = dial.slider();
        INFO(number->getName(40));
        slider.setValue(number->scale().range.least, juce::sendNotificationSync);
        double last = number->get();
        for (int k = 0; k < 5; ++k) {
            CHECK(slider.keyPressed(juce::KeyPress(juce::KeyPress::rightKey)));
            CHECK(number->get() > last);
            last = number->get();
        }
        for (int k = 0; k < 30; ++k)
            slider.keyPressed(juce::KeyPress(juce::KeyPress::pageUpKey));
        CHECK(number->get() == number->scale().range.most);
        CHECK(slider.keyPressed(juce::KeyPress(juce::KeyPress::leftKey)));
        CHECK(number->get() < number->scale().range.most);
        CHECK(slider.keyPressed(juce::KeyPress(juce::KeyPress::homeKey)));
        CHECK(number->get() == number->first());
    }
}

TEST_CASE("What a person moved is undone and done again; what a host moved is not", "[plugin]")
{
    Processor processor;
    Editor editor(processor);
    editor.go(PageName::linearize);
    editor.update();
    auto& parameters = processor.parameters();
    auto& number = *parameters.numbers()[0];
    const auto dials = plugin::all<plugin::Dial>(editor.body());
    REQUIRE(dials.size() + 1 == parameters.numbers().size());  // a driver knows the resistance of its coil
    const double first = number.get();
    CHECK_FALSE(editor.history().canUndo());

    // A drag is one step.
    dials[0]->onDragStart();
    for (const double value : {11.0, 12.0, 13.0})
        dials[0]->setValue(value, juce::sendNotificationSync);
    dials[0]->onDragEnd();
    CHECK(number.get() == 13.0);
    CHECK(editor.keyPressed(ctrl('Z')));
    CHECK(number.get() == first);
    CHECK(dials[0]->getValue() == first);
    CHECK_FALSE(editor.history().canUndo());
    CHECK(editor.keyPressed(ctrl('Z', true)));
    CHECK(number.get() == 13.0);

    parameters.numbers()[1]->setValue(0.25f);  // a host
    editor.update();
    auto& mode = parameters.mode();
    const int before = mode.getIndex();
    for (auto* box : plugin::all<juce::ComboBox>(editor.body()))
        if (box->getTitle() == "Mode")
            box->setSelectedItemIndex(before == 3 ? 0 : 3, juce::sendNotificationSync);
    CHECK(mode.getIndex() != before);
    CHECK(editor.history().nextBack() == "Mode");
    const auto switches = plugin::all<juce::ToggleButton>(editor.body());
    REQUIRE(!switches.empty());
    const bool on = switches[0]->getToggleState();
    switches[0]->setToggleState(!on, juce::dontSendNotification);
    switches[0]->onClick();
    const auto all = parameters.recipe();
    editor.undo();
    CHECK(switches[0]->getToggleState() == on);
    editor.undo();
    CHECK(mode.getIndex() == before);
    CHECK(number.get() == 13.0);
    editor.undo();
    CHECK(number.get() == first);
    CHECK(parameters.numbers()[1]->getValue() == Approx(0.25f));
    for (int k = 0; k < 3; ++k)
        editor.redo();
    CHECK(toJson(parameters.recipe()) == toJson(all));

    // A recipe and a model are a step each.
    for (auto* box : plugin::all<juce::ComboBox>(editor.body())) {
        if (box->getTitle() == "Recipes")
            for (int again = 0; again < 2; ++again) {  // after a dial was moved the same one may be wanted again
                parameters.numbers()[1]->setValue(0.25f);
                box->setSelectedId(0, juce::dontSendNotification);  // as where it opens
                box->setSelectedItemIndex(1, juce::sendNotificationSync);
                CHECK(parameters.numbers()[1]->getValue() != 0.25f);
                if (again == 1)
                    editor.undo();
            }
    }
    CHECK(toJson(parameters.recipe()) != toJson(all));
    const auto driver = processor.model().name;
    const auto other = plugin::factoryDrivers().front();
    editor.use(plugin::modelFromText(other.text, other.title), "a test");
    REQUIRE(processor.model().name != driver);
    editor.undo();
    CHECK(processor.model().name == driver);
    editor.undo();
    CHECK(toJson(parameters.recipe()) == toJson(all));
    editor.redo();
    editor.redo();
    CHECK(processor.model().name != driver);
}

TEST_CASE("Keys choose the page and the scale", "[plugin]")
{
    Processor processor;
    Editor editor(processor);
    for (int k = 0; k < 5; ++k) {
        CHECK(editor.keyPressed(ctrl('1' + k)));
        CHECK(editor.page(static_cast<PageName>(k)).isVisible());
    }
    CHECK(editor.keyPressed(ctrl(juce::KeyPress::pageDownKey)));
    CHECK(editor.page(PageName::measure).isVisible());
    CHECK(editor.keyPressed(ctrl(juce::KeyPress::pageUpKey)));
    CHECK(editor.page(PageName::linearize).isVisible());
    editor.setSize(1600, 1200);
    CHECK(editor.keyPressed(ctrl('0')));
    const double scale = editor.shownScale();
    CHECK(editor.keyPressed(ctrl('+')));
    CHECK(editor.shownScale() > scale);
    CHECK(editor.keyPressed(ctrl('-')));
    CHECK(editor.keyPressed(ctrl('-')));
    CHECK(editor.shownScale() <= scale);
    CHECK_FALSE(editor.keyPressed(juce::KeyPress('z')));
    CHECK_FALSE(editor.keyPressed(ctrl('K')));
    plugin::preferencesFile().deleteFile();
}
