// SPDX-License-Identifier: GPL-3.0-or-later
// How large the window is drawn, in which colours, and where its parts stand.
#include "Plugin/Editor.h"

#include "Plugin/Look.h"

#include <algorithm>
#include <cmath>

namespace excursion::plugin {
namespace {

/// A field keeps the colour that its text was put in with, which may have been before the window had a look.
void recolourTexts(juce::Component& part)
{
    if (auto* field = dynamic_cast<juce::TextEditor*>(&part))
        field->applyColourToAllText(look::palette().text);
    for (auto* child : part.getChildren())
        recolourTexts(*child);
}

}  // namespace

/// In the file of preferences, unless it says the same.
void Editor::keep()
{
    const auto kept = readPreferences(preferencesFile());
    preferences_.width = getWidth();
    preferences_.height = getHeight();
    if (kept.scale != preferences_.scale || kept.theme != preferences_.theme || kept.width != preferences_.width
        || kept.height != preferences_.height)
        writePreferences(preferences_, preferencesFile());
}

juce::Rectangle<int> Editor::room() const
{
    const auto& displays = juce::Desktop::getInstance().getDisplays();
    const auto* display = isShowing() ? displays.getDisplayForRect(getScreenBounds()) : displays.getPrimaryDisplay();
    if (display == nullptr || display->userArea.isEmpty())
        return {0, 0, 1280, 800};
    constexpr int frame = 60;  // px: the title of a window, and a note above the editor that the app may show
    auto area = display->userArea;
    return {0, 0, std::max(leastWidth, area.getWidth() * 9 / 10),
            std::max(leastHeight, area.getHeight() * 9 / 10 - frame)};
}

double Editor::shownScale() const
{
    const double across = getWidth() / static_cast<double>(leastWidth),
                 down = getHeight() / static_cast<double>(leastHeight), most = std::min(across, down);
    if (preferences_.scale > 0.0)
        return std::min(preferences_.scale, most);
    // Half of what the window is larger than a small screen goes into size, half into room.
    const double larger = std::min(getWidth() / 1280.0, getHeight() / 800.0);
    return std::min(most, std::clamp(0.5 + 0.5 * larger, 1.0, Preferences::mostScale));
}

void Editor::setScale(double scale)
{
    const bool open = getWidth() > 0;
    preferences_.scale = scale > 0.0 ? std::clamp(scale, Preferences::leastScale, Preferences::mostScale) : 0.0;
    const double least = preferences_.scale > 0.0 ? std::min(1.0, preferences_.scale) : 1.0;
    setResizeLimits(static_cast<int>(leastWidth * least), static_cast<int>(leastHeight * least), 16384, 16384);
    if (!open)
        return;
    // A window that is too small for it grows as far as the screen lets it.
    const auto screen = room();
    const auto wanted = [&](int now, int needed, int most) {
        return std::max(now, std::min(most, static_cast<int>(std::ceil(needed * preferences_.scale))));
    };
    setSize(wanted(getWidth(), leastWidth, screen.getWidth()), wanted(getHeight(), leastHeight, screen.getHeight()));
    resized();
    if (preferences_.scale > shownScale() + 0.005)
        tell("The window is drawn at " + whole(100.0 * shownScale()) + " %: more does not fit on the screen.", false);
    keep();
}

void Editor::setTheme(look::Theme theme)
{
    preferences_.theme = theme;
    recolour();
    keep();
}

void Editor::recolour()
{
    look_->use(preferences_.theme);
    coloured_ = look_->version();
    sendLookAndFeelChange();
    recolourTexts(body_);
    for (auto* page : pages_)
        page->recolour();
    if (auto* window = findParentComponentOfClass<juce::ResizableWindow>())
        window->setBackgroundColour(look::palette().background);
    repaint();
}

void Editor::showView()
{
    juce::PopupMenu scales, themes, keys, menu;
    const auto safe = juce::Component::SafePointer<Editor>(this);
    const auto scale = [&](const juce::String& text, double value) {
        scales.addItem(text, true, preferences_.scale == value, [safe, value] {
            if (safe != nullptr)
                safe->setScale(value);
        });
    };
    scale("Grows with the window", 0.0);
    for (const double value : {0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0})
        scale(whole(100.0 * value) + " %", value);
    const auto theme = [&](const juce::String& text, look::Theme value) {
        themes.addItem(text, true, preferences_.theme == value, [safe, value] {
            if (safe != nullptr)
                safe->setTheme(value);
        });
    };
    theme("As the system", look::Theme::system);
    theme("Light", look::Theme::light);
    theme("Dark", look::Theme::dark);
    for (const auto* text :
         {"Ctrl+1 to Ctrl+5: pages", "Ctrl+Page Up, Ctrl+Page Down: one page on", "Ctrl+Z, Ctrl+Shift+Z: undo, redo",
          "Ctrl+O: open a take", "Ctrl with +, - and 0: scale", "Tab, Shift+Tab: from control to control",
          "Arrows, Page Up, Page Down, Home: move a slider",
          "On a plot: arrows read, + and - zoom, Home shows all, Return saves",
          "Mouse on a plot: draw a frame, turn the wheel (Shift: up and down), double click"})
        keys.addItem(juce::PopupMenu::Item(text).setEnabled(true).setAction([] {}));
    menu.addSubMenu("Scale", scales);
    menu.addSubMenu("Theme", themes);
    menu.addSubMenu("Keys and mouse", keys);
    menu.setLookAndFeel(&*look_);
    menu.showMenuAsync(juce::PopupMenu::Options().withTargetComponent(view_));
}

void Editor::paint(juce::Graphics& g) { g.fillAll(look::palette().background); }

void Editor::resized()
{
    if (getWidth() == 0 || getHeight() == 0)
        return;
    const double scale = shownScale();
    const juce::Rectangle<int> area(0, 0, static_cast<int>(std::round(getWidth() / scale)),
                                    static_cast<int>(std::round(getHeight() / scale)));
    body_.setTransform(juce::AffineTransform::scale(static_cast<float>(scale)));
    body_.setBounds(area);
    layOut(area);
    ring_.follow();
}

void Editor::layOut(juce::Rectangle<int> area)
{
    area.reduce(12, 10);
    auto head = area.removeFromTop(30);
    view_.setBounds(head.removeFromRight(64));
    head.removeFromRight(8);
    redo_.setBounds(head.removeFromRight(60));
    head.removeFromRight(4);
    undo_.setBounds(head.removeFromRight(60));
    head.removeFromRight(8);
    const int each = std::min(120, head.getWidth() / static_cast<int>(tabs_.size()));
    for (auto& tab : tabs_)
        tab.setBounds(head.removeFromLeft(each));
    area.removeFromTop(8);
    auto foot = area.removeFromBottom(34);
    cancel_.setBounds(foot.removeFromRight(80).reduced(0, 3));
    foot.removeFromRight(8);
    progress_.setBounds(foot.removeFromRight(150).reduced(0, 6));
    foot.removeFromRight(8);
    status_.setBounds(foot);
    area.removeFromBottom(4);
    for (auto* page : pages_)
        page->setBounds(area);
    if (question_)
        question_->setBounds(body_.getLocalBounds());
}

}  // namespace excursion::plugin
