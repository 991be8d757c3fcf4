// SPDX-License-Identifier: GPL-3.0-or-later
// What the window shows can be read at every size, light and dark.
#include "BlackBox/EveryClass.h"
#include "Engine/Error.h"
#include "Plugin/Walk.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>

using namespace excursion;
using plugin::Editor;
using plugin::PageName;
using plugin::Processor;
using plugin::words;

namespace {

constexpr std::pair<int, int> sizes[] {{800, 560}, {1024, 700}, {1280, 800}, {1920, 1080}, {2560, 1440}};
constexpr std::pair<PageName, const char*> pageNames[] {{PageName::measure, "measure"},
                                                        {PageName::compare, "compare"},
                                                        {PageName::diagnose, "diagnose"},
                                                        {PageName::identify, "identify"},
                                                        {PageName::linearize, "linearize"}};

void keepPicture(Editor& editor, const juce::String& name)
{
    const auto image = editor.createComponentSnapshot(editor.getLocalBounds());
    const juce::File file(juce::String(EXCURSION_SCREENSHOTS) + "/" + name + ".png");
    file.getParentDirectory().createDirectory();
    file.deleteFile();
    juce::FileOutputStream stream(file);
    CHECK(juce::PNGImageFormat().writeImageToStream(image, stream));
}

/// Whether the text can be read in full where it stands.
bool fits(const juce::String& text, const juce::Font& font, int width, int height)
{
    if (height < 1.9f * font.getHeight())
        return font.withHeight(0.78f * font.getHeight()).getStringWidthFloat(text) <= static_cast<float>(width) + 0.5f
               && static_cast<float>(height) + 0.5f >= font.getHeight();
    juce::AttributedString words;
    words.append(text, font.withHeight(0.78f * font.getHeight()));
    juce::TextLayout layout;
    layout.createLayout(words, static_cast<float>(width));
    return layout.getHeight() <= static_cast<float>(height) + 0.5f;
}

void checkTexts(juce::Component& root)
{
    plugin::walk(root, [](juce::Component& one) {
        if (auto* label = dynamic_cast<juce::Label*>(&one)) {
            const auto area = label->getBorderSize().subtractedFrom(label->getLocalBounds());
            INFO("label \"" << label->getText() << "\" in " << area.toString());
            CHECK(fits(label->getText(), label->getFont(), area.getWidth(), area.getHeight()));
        } else if (auto* button = dynamic_cast<juce::TextButton*>(&one)) {
            INFO("button \"" << button->getButtonText() << "\" in " << button->getBounds().toString());
            CHECK(fits(button->getButtonText(), juce::Font(14.0f), button->getWidth() - 12, button->getHeight()));
        } else if (auto* toggle = dynamic_cast<juce::ToggleButton*>(&one)) {
            INFO("switch \"" << toggle->getButtonText() << "\" in " << toggle->getBounds().toString());
            CHECK(fits(toggle->getButtonText(), juce::Font(14.0f), toggle->getWidth() - 27, toggle->getHeight()));
        } else if (auto* card = dynamic_cast<plugin::Card*>(&one)) {
            INFO("card \"" << card->getTitle() << "\"");
            CHECK(card->getHeight() >= card->heightFor(card->getWidth()));
        }
    });
}

/// At least three labels that do not touch, on each axis of numbers.
void checkLabels(plugin::PlotView& view)
{
    if (view.plot().series.empty())
        return;
    for (const bool across : {true, false}) {
        const auto& axis = across ? view.plot().x : view.plot().y;
        if (!axis.names.empty())
            continue;
        const auto labels = view.labels(across);
        INFO(view.getTitle() << ", " << view.getBounds().toString() << (across ? ", across" : ", up"));
        CHECK(labels.size() >= 3);
        for (std::size_t k = 1; k < labels.size(); ++k) {
            CHECK(labels[k].text != labels[k - 1].text);
            CHECK(labels[k].value > labels[k - 1].value);
        }
    }
}

/// Everything of the page is seen in full, and nothing covers anything else.
void checkPage(Editor& editor, PageName name)
{
    checkTexts(editor.body());
    for (auto* view : plugin::all<plugin::PlotView>(editor.body()))
        checkLabels(*view);
    auto& page = editor.page(name);
    CHECK(editor.body().getLocalBounds().contains(page.getBounds()));
    const auto& children = page.getChildren();
    for (int a = 0; a < children.size(); ++a) {
        if (!children[a]->isVisible())
            continue;
        INFO(children[a]->getTitle() << " " << children[a]->getBounds().toString());
        CHECK_FALSE(children[a]->getBounds().isEmpty());
        CHECK(page.getLocalBounds().contains(children[a]->getBounds()));
        for (int b = 0; b < a; ++b)
            CHECK_FALSE((children[b]->isVisible() && children[b]->getBounds().intersects(children[a]->getBounds())));
    }
}

}  // namespace

TEST_CASE("Every page can be read at every size: nothing is cut off or covered, and every axis has three labels",
          "[plugin]")
{
    Processor processor;
    Editor editor(processor);
    const auto rungs = GENERATE(1, 4);
    editor.show(plugin::syntheticFindings(static_cast<std::size_t>(rungs)));
    processor.session().put(
        plugin::identifiedForPictures(rungs == 1 ? plugin::ModelTime::continuous : plugin::ModelTime::fractional));
    editor.identify().choose(processor.session().identification().linear->asked);
    for (const auto theme : {plugin::look::Theme::light, plugin::look::Theme::dark}) {
        editor.setTheme(theme);
        for (const auto& [width, height] : sizes) {
            editor.setSize(width, height);
            for (const auto& [name, word] : pageNames) {
                editor.go(name);
                editor.update();
                INFO(word << " at " << width << " x " << height << ", " << rungs << " rungs");
                if (std::getenv("EXCURSION_ALL_PICTURES") != nullptr || (width == 1024 && rungs > 1))
                    keepPicture(editor, juce::String("sizes/") + word + "-" + juce::String(width) + "-"
                                            + juce::String(rungs)
                                            + (theme == plugin::look::Theme::dark ? "-dark" : "-light"));
                if (theme == plugin::look::Theme::dark)
                    continue;  // of the same shape
                checkPage(editor, name);
            }
        }
    }
}

TEST_CASE("A model without physics can be read at every size, whether it can be inverted or not", "[plugin][blackbox]")
{
    Processor processor;
    Editor editor(processor);
    editor.go(PageName::linearize);
    auto documents = everyClass();
    auto refused = everyClass().front();
    for (auto& term : refused["terms"])
        for (auto& coefficient : term["E"])
            coefficient = 0.0;
    documents.push_back(refused);
    for (const auto& document : documents) {
        processor.rehearsing().load(document, "box.json");
        processor.rehearsing().wait();
        editor.update();
        const auto name = words(processor.box()->played.box.name)
                          + (processor.box()->played.rehearsal ? "" : "-refused");
        for (const auto theme : {plugin::look::Theme::light, plugin::look::Theme::dark}) {
            editor.setTheme(theme);
            for (const auto& [width, height] : sizes) {
                editor.setSize(width, height);
                editor.update();
                INFO(name << " at " << width << " x " << height);
                if (std::getenv("EXCURSION_ALL_PICTURES") != nullptr || width == 1024)
                    keepPicture(editor, "sizes/box-" + name + "-" + juce::String(width)
                                            + (theme == plugin::look::Theme::dark ? "-dark" : "-light"));
                checkPage(editor, PageName::linearize);
            }
        }
    }
}

TEST_CASE("A target and what it costs can be read at every size", "[plugin][target]")
{
    Processor processor;
    Editor editor(processor);
    editor.go(PageName::linearize);
    auto& panel = dynamic_cast<plugin::LinearizePage&>(editor.page(PageName::linearize)).target();
    for (const auto kind : {Target::Kind::own, Target::Kind::resonance, Target::Kind::closedBox})
        for (const bool pictured : {false, true}) {
            auto recipe = processor.parameters().recipe();
            recipe.target = {kind, 40.0, 0.7, 0.015};
            recipe.voltageLimit = 25.0;
            recipe.fullScale = 20.0;
            processor.parameters().set(recipe);
            panel.choosePicture(pictured);
            const auto drawn = [&panel] {
                for (auto* label : plugin::all<juce::Label>(panel))
                    if (label->getText().contains("being computed"))
                        return false;
                const auto plots = plugin::all<plugin::PlotView>(panel);
                return !plots.empty() && plots.front()->plot().series.size() > 1;
            };
            for (int k = 0; k < 3000 && pictured && (k < 40 || !drawn()); ++k) {
                editor.update();
                juce::Thread::sleep(20);
            }
            editor.update();
            CHECK((!pictured || drawn()));
            for (const auto theme : {plugin::look::Theme::light, plugin::look::Theme::dark}) {
                editor.setTheme(theme);
                for (const auto& [width, height] : sizes) {
                    editor.setSize(width, height);
                    editor.update();
                    INFO("target " << static_cast<int>(kind) << " at " << width << " x " << height);
                    if (std::getenv("EXCURSION_ALL_PICTURES") != nullptr || width == 1024)
                        keepPicture(editor, "sizes/target-" + juce::String(static_cast<int>(kind))
                                                + (pictured ? "-costs-" : "-") + juce::String(width)
                                                + (theme == plugin::look::Theme::dark ? "-dark" : "-light"));
                    if (theme == plugin::look::Theme::light)
                        checkPage(editor, PageName::linearize);
                }
            }
        }
}
