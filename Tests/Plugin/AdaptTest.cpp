// SPDX-License-Identifier: GPL-3.0-or-later
// A model that follows what has drifted, as a person asks for it on the last page.
#include "Engine/Upkeep/Adaptation.h"
#include "Plugin/Walk.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace excursion;
using plugin::Editor;
using plugin::PageName;
using plugin::Processor;

namespace {

juce::TextButton* adaptButton(Editor& editor)
{
    for (auto* button : plugin::all<juce::TextButton>(editor.page(PageName::linearize)))
        if (button->getButtonText() == "Adapt")
            return button;
    return nullptr;
}

}  // namespace

TEST_CASE("A driver whose coil is warmer than its model follows the take, and the page tells what has drifted",
          "[plugin][adapt]")
{
    Processor processor;
    Editor editor(processor);
    editor.go(PageName::linearize);
    editor.update();
    auto* adapt = adaptButton(editor);
    REQUIRE(adapt != nullptr);
    CHECK_FALSE(adapt->isEnabled());  // there is no take
    processor.session().open(plugin::VirtualOrder {"midbass", 4});
    processor.session().wait();
    const auto findings = processor.session().findings();
    REQUIRE(findings);
    const auto fitted = findings->file.ladder.model();
    auto before = fitted;
    before.baseParameter("Re").value *= 0.9;
    processor.setModel(before);
    editor.update();
    REQUIRE(adapt->isEnabled());
    adapt->onClick();
    processor.session().wait();
    CHECK_FALSE(processor.session().status().trouble);
    editor.update();
    editor.update();  // what has drifted stays told
    CHECK(processor.model().baseParameter("Re").value == Approx(fitted.baseParameter("Re").value).epsilon(0.01));
    juce::String told;
    for (auto* label : plugin::all<juce::Label>(editor.page(PageName::linearize)))
        if (label->getText().startsWith("Since it was fitted"))
            told = label->getText();
    INFO(told);
    CHECK(told.contains("Re "));
    CHECK(told.contains("warmer"));
    CHECK(told.contains("f0"));
    editor.undo();
    CHECK(processor.model().baseParameter("Re").value == Approx(before.baseParameter("Re").value));
    editor.update();
    for (auto* label : plugin::all<juce::Label>(editor.page(PageName::linearize)))
        CHECK_FALSE(label->getText().startsWith("Since it was fitted"));  // it is of a model that is gone
    // Once; and it is not taken again
    CHECK_FALSE(processor.session().takeAdapted());

    // What a person has loaded meanwhile stays.
    adapt->onClick();
    processor.setModel(plugin::modelFromText(plugin::factoryDrivers().back().text, "a driver"));
    processor.session().wait();
    editor.update();
    editor.update();
    CHECK(processor.model().name == plugin::factoryDrivers().back().title);
    CHECK(editor.status().contains("loaded meanwhile"));
    CHECK_FALSE(processor.session().takeAdapted());
}

TEST_CASE("That nothing has drifted is said only where no parameter moved by more than its errors let it", "[adapt]")
{
    Adaptation adapted;
    for (auto* comparison : {&adapted.before, &adapted.after}) {
        comparison->noiseKnown = true;
        comparison->chiSquaredPerValue = 1.1;
    }
    adapted.drift.parameters = {{"Re", "ohm", 3.30, 0.01, 3.31, 0.01}};
    CHECK_THAT(sentenceOn(adapted), Catch::Contains("nothing has drifted"));
    adapted.drift.parameters.push_back({"K", "N/m", 1850.0, 2.0, 1900.0, 2.0});
    CHECK_THAT(sentenceOn(adapted), !Catch::Contains("nothing has drifted"));
    adapted.drift.parameters.back().afterError = std::numeric_limits<double>::quiet_NaN();
    CHECK_THAT(sentenceOn(adapted), Catch::Contains("nothing has drifted"));
}
