// SPDX-License-Identifier: GPL-3.0-or-later
// The window itself: its size and scale, what of them is kept, where a page begins.
#include "BlackBox/EveryClass.h"
#include "Engine/Error.h"
#include "Plugin/FillList.h"
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

TEST_CASE("A new diagnosis is read from its beginning, wherever the one before was left", "[plugin]")
{
    Processor processor;
    Editor editor(processor);
    editor.setSize(800, 560);
    editor.go(PageName::diagnose);
    editor.show(plugin::syntheticFindings(3));
    const auto lists = plugin::all<juce::Viewport>(editor.diagnose());
    REQUIRE(lists.size() == 1);
    lists.front()->setViewPosition(0, 150);
    REQUIRE(lists.front()->getViewPositionY() == 150);
    editor.show(plugin::syntheticFindings(4));
    CHECK(lists.front()->getViewPositionY() == 0);
}

TEST_CASE("A list that gets the items that it has is left alone, so that one that is open stays open", "[plugin]")
{
    juce::ComboBox list;
    plugin::fillList(list, {"base", "K(x)"}, 1);
    CHECK(list.getText() == "K(x)");
    list.setItemEnabled(1, false);  // which another filling would forget
    plugin::fillList(list, {"base", "K(x)"}, 0);
    CHECK(list.getText() == "K(x)");
    CHECK(!list.isItemEnabled(1));
    plugin::fillList(list, {"base", "Bl(x)", "K(x)"}, 2);
    CHECK(list.getText() == "Bl(x)");  // the place stays
    CHECK(list.isItemEnabled(1));
    plugin::fillList(list, {"base"}, 0);
    CHECK(list.getText() == "base");
}

TEST_CASE("The window opens within nine tenths of the screen, and what was chosen of it is kept", "[plugin]")
{
    const auto file = plugin::preferencesFile();
    file.deleteFile();
    Processor processor;
    {
        Editor editor(processor);
        CHECK(editor.getWidth() <= editor.room().getWidth());
        CHECK(editor.getHeight() <= editor.room().getHeight());
        auto* limits = editor.getConstrainer();
        REQUIRE(limits != nullptr);
        CHECK(limits->getMinimumWidth() <= 800);
        CHECK(limits->getMinimumHeight() <= 560);
        editor.setSize(900, 600);
        editor.setTheme(plugin::look::Theme::light);
        editor.setScale(0.75);
        CHECK(editor.shownScale() == 0.75);
        CHECK(limits->getMinimumWidth() == 600);
    }
    {
        Editor editor(processor);
        CHECK(editor.shownScale() == 0.75);
        CHECK(editor.getWidth() == 900);
        CHECK(plugin::look::palette().background == plugin::look::light.background);
        editor.setScale(0.0);
        editor.setTheme(plugin::look::Theme::dark);
    }
    const auto kept = plugin::readPreferences(file);
    CHECK(kept.scale == 0.0);
    CHECK(kept.theme == plugin::look::Theme::dark);
    for (const auto* broken : {"", "{", "[]", "{\"scale\": \"big\"}", "{\"scale\": 99, \"theme\": 3, \"width\": -1}"}) {
        file.replaceWithText(broken);
        const auto read = plugin::readPreferences(file);
        CHECK(read.scale == 0.0);
        CHECK(read.theme == plugin::look::Theme::system);
        CHECK(read.width == 0);
    }
    file.deleteFile();
}

TEST_CASE("The scale goes from 75 to 300 %, and never cuts off what is laid out", "[plugin]")
{
    Processor processor;
    Editor editor(processor);
    for (const double scale : {0.75, 1.0, 1.5, 2.0, 3.0}) {
        editor.setScale(scale);
        editor.setSize(2600, 1800);
        CHECK(editor.shownScale() == scale);
        CHECK(std::abs(editor.body().getWidth() - 2600 / scale) <= 1.0);
        editor.setSize(1000, 600);
        CHECK(editor.body().getWidth() >= Editor::leastWidth);
        CHECK(editor.body().getHeight() >= Editor::leastHeight);
    }
    editor.setScale(0.0);
    editor.setSize(1100, 700);
    CHECK(editor.shownScale() == 1.0);
    editor.setSize(2560, 1440);
    CHECK(editor.shownScale() > 1.3);
    editor.setScale(0.1);
    CHECK(editor.shownScale() == 0.75);
    plugin::preferencesFile().deleteFile();
}
