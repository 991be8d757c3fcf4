// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Dials.h"
#include "Plugin/Processor.h"

#include <catch2/catch.hpp>

#include <limits>
#include <vector>

using namespace excursion;
using plugin::Processor;

namespace {

/// What a host hears, a letter each: begin, change, end.
struct Host : juce::AudioProcessorListener {
    explicit Host(Processor& of) : processor(of) { processor.addListener(this); }
    ~Host() override { processor.removeListener(this); }
    void audioProcessorParameterChanged(juce::AudioProcessor*, int, float) override { heard += "c"; }
    void audioProcessorChanged(juce::AudioProcessor*, const ChangeDetails&) override {}
    void audioProcessorParameterChangeGestureBegin(juce::AudioProcessor*, int) override { heard += "b"; }
    void audioProcessorParameterChangeGestureEnd(juce::AudioProcessor*, int) override { heard += "e"; }
    Processor& processor;
    std::string heard;
};

}  // namespace

TEST_CASE("A dial puts a number on the nearest step and tells the host of one gesture; what a host sends, it follows "
          "silently",
          "[plugin]")
{
    Processor processor;
    Host host(processor);
    auto& number = *processor.parameters().numbers().front();
    plugin::NumberDial dial(number);
    auto& slider = dial.slider();
    CHECK(slider.getValue() == number.get());
    slider.setValue(2.8284271, juce::sendNotificationSync);
    CHECK(number.get() == 2.83);
    CHECK(slider.getValue() == 2.83);
    CHECK(host.heard == "bce");
    host.heard.clear();
    slider.onDragStart();
    slider.setValue(3.0, juce::sendNotificationSync);
    slider.setValue(4.0, juce::sendNotificationSync);
    slider.onDragEnd();
    CHECK(host.heard == "bcce");
    CHECK(number.get() == 4.0);
    host.heard.clear();
    number.setValue(0.7f);
    CHECK(slider.getValue() == 4.0);
    dial.follow();
    CHECK(slider.getValue() == number.get());
    CHECK(number.getValue() == 0.7f);
    CHECK(host.heard.empty());
    CHECK(slider.getValueFromText("500 V") == 500.0);
    slider.setValue(slider.getValueFromText("500 V"), juce::sendNotificationSync);
    CHECK(number.get() == 500.0);
    auto& share = *processor.parameters().numbers()[1];
    plugin::NumberDial percent(share);
    percent.slider().setValue(percent.slider().getValueFromText("33.3 %"), juce::sendNotificationSync);
    CHECK(share.get() == 0.333);
    CHECK(percent.slider().getTextFromValue(share.get()) == "33.3 %");
}

TEST_CASE("What is typed into a dial and is no number leaves it as it is", "[plugin]")
{
    Processor processor;
    auto& parameters = processor.parameters();
    std::vector<plugin::Number*> numbers = parameters.numbers();
    for (auto* number : parameters.targetNumbers())
        numbers.push_back(number);
    for (auto* number : numbers) {
        INFO(number->getName(40));
        plugin::NumberDial dial(*number);
        auto& slider = dial.slider();
        const double before = number->snapped(number->at(0.4));
        number->set(before);
        dial.follow();
        const float proportion = number->getValue();
        for (const auto* typed : {"0,5", "", "-", "1.2.3", "1-2", "e5", "1e999", "nan", "inf", "none", "off",
                                  "5 apples", "V", "No limit at all"}) {
            INFO('"' << typed << '"');
            slider.setValue(slider.getValueFromText(typed), juce::sendNotificationSync);
            CHECK(number->get() == before);
            CHECK(number->getValueForText(typed) == proportion);
        }
        for (const double wild : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                                  -std::numeric_limits<double>::infinity()}) {
            number->set(wild);
            CHECK(number->get() == before);
        }
        const auto& scale = number->scale();
        if (*scale.most)
            CHECK(number->valueOf(juce::String(scale.most).toUpperCase()) == scale.range.most);
        if (*scale.least)
            CHECK(number->valueOf(" " + juce::String(scale.least).toUpperCase()) == scale.range.least);
        for (const auto& typed : {number->words(before), number->text(before), "+" + number->text(before)})
            CHECK(number->valueOf(typed).value() == Approx(before));
    }
    plugin::Dial plain(juce::Slider::LinearHorizontal, juce::Slider::TextBoxRight);
    plain.setRange(0.2, 1.2, 0.01);
    plain.setValue(0.9, juce::dontSendNotification);
    CHECK(plain.getValueFromText("0,5") == Approx(0.9));
    CHECK(plain.getValueFromText("0.5") == 0.5);
}

TEST_CASE("An end of a dial that is no number is called by its word", "[plugin]")
{
    Processor processor;
    for (auto* number : processor.parameters().numbers()) {
        const auto& scale = number->scale();
        plugin::NumberDial dial(*number);
        auto& slider = dial.slider();
        if (number->getName(99) == "Power limit") {
            CHECK(slider.getTextFromValue(scale.range.most) == "no limit");
            CHECK(slider.getValueFromText("no limit") == scale.range.most);
            CHECK(number->getText(1.0f, 0) == "no limit");
            CHECK(number->getValueForText("no limit") == 1.0f);
            CHECK(slider.getTextFromValue(100.0) == "100.00 W");
        }
        if (number->getName(99) == "Coil resistance") {
            CHECK(slider.getTextFromValue(0.0) == "not known");
            CHECK(slider.getValueFromText("not known") == 0.0);
            CHECK(slider.getTextFromValue(6.0) == "6.00 ohm");
        }
    }
}

TEST_CASE("A switch and a choice tell the host of one gesture, and follow it silently", "[plugin]")
{
    Processor processor;
    Host host(processor);
    auto& effect = *processor.parameters().effects().front();
    plugin::OnOffButton button(effect);
    CHECK(button.button().getToggleState());
    button.button().setToggleState(false, juce::dontSendNotification);
    button.button().onClick();
    CHECK_FALSE(effect.get());
    CHECK(host.heard == "bce");
    host.heard.clear();
    effect.setValue(0.84f);
    button.follow();
    CHECK(button.button().getToggleState());
    auto& mode = processor.parameters().mode();
    plugin::ChoiceBox choice(mode);
    mode.setValue(0.84f);
    choice.follow();
    CHECK(choice.box().getSelectedItemIndex() == 3);
    CHECK(mode.getValue() == 0.84f);
    CHECK(effect.getValue() == 0.84f);
    CHECK(host.heard.empty());
    choice.box().setSelectedItemIndex(1, juce::sendNotificationSync);
    CHECK(mode.getIndex() == 1);
    CHECK(host.heard == "bce");
}
