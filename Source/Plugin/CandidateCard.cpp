// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/CandidateCard.h"

#include "Engine/Document/Engineering.h"
#include "Plots/Words.h"
#include "Plugin/Look.h"
#include "Plugin/Text.h"

#include <cmath>

namespace excursion::plugin {
namespace {

constexpr float headHeight = 24.0f, sureHeight = 18.0f, gaugeWidth = 60.0f, bodyHeight = 13.5f;

/// "current −28.1 → −60.2 dB (predicted)", where no refit has shown it; of one that has, the reason tells.
juce::String fallOf(const RankedEffect& ranked, const ErrorByChannel& before)
{
    if (!ranked.confirmedErrorDb.empty() && !ranked.reason.empty())
        return {};
    const auto& after = ranked.confirmedErrorDb.empty() ? ranked.predictedErrorDb : ranked.confirmedErrorDb;
    juce::StringArray parts;
    for (const auto& [quantity, error] : before)
        if (const auto found = after.find(quantity); found != after.end())
            parts.add(words(std::string(name(quantity)) + "\u00a0" + fixedText(error.db, 1) + "\u00a0\u2192\u00a0"
                            + fixedText(found->second, 1)));
    return parts.joinIntoString(",  ") + words("\u00a0dB")
           + (ranked.confirmedErrorDb.empty() ? " (predicted)" : juce::String());
}

float heightOf(const juce::AttributedString& text, float width)
{
    juce::TextLayout layout;
    layout.createLayout(text, width);
    return std::ceil(layout.getHeight());
}

}  // namespace

Card::Card(std::function<void()> selected) : selected_(std::move(selected)) { setWantsKeyboardFocus(true); }

void Card::choose(bool chosen)
{
    chosen_ = chosen;
    repaint();
}

void Card::paint(juce::Graphics& g)
{
    const auto area = getLocalBounds().toFloat().reduced(1.0f, 3.0f);
    g.setColour(look::palette().panel);
    g.fillRoundedRectangle(area, 4.0f);
    if (chosen_) {
        g.setColour(look::palette().accent);
        g.fillRect(area.withWidth(3.0f));
    }
}

bool Card::keyPressed(const juce::KeyPress& key)
{
    if (key == juce::KeyPress::returnKey || key == juce::KeyPress::spaceKey) {
        selected_();
        return true;
    }
    if (key == juce::KeyPress::downKey || key == juce::KeyPress::upKey) {
        // the next card, over the button that lies between
        auto& parent = *getParentComponent();
        const int step = key == juce::KeyPress::downKey ? 1 : -1;
        for (int k = parent.getIndexOfChildComponent(this) + step; k >= 0 && k < parent.getNumChildComponents();
             k += step)
            if (auto* next = dynamic_cast<Card*>(parent.getChildComponent(k))) {
                next->grabKeyboardFocus();
                break;
            }
        return true;
    }
    return false;
}

void Card::focusGained(FocusChangeType)
{
    if (auto* port = findParentComponentOfClass<juce::Viewport>()) {
        const int above = port->getViewPositionY(), below = getBottom() - port->getViewHeight();
        port->setViewPosition(0, juce::jmin(getY(), juce::jmax(above, below)));
    }
}

std::unique_ptr<juce::AccessibilityHandler> Card::createAccessibilityHandler()
{
    return std::make_unique<juce::AccessibilityHandler>(
        *this, juce::AccessibilityRole::listItem,
        juce::AccessibilityActions().addAction(juce::AccessibilityActionType::press, [this] { selected_(); }));
}

CandidateCard::CandidateCard(const RankedEffect& ranked, const ErrorByChannel& before, std::size_t place,
                             std::function<void()> selected, std::function<void()> added)
    : Card(std::move(selected)),
      title_(juce::String(static_cast<int>(place) + 1) + ".  " + words(effectTitle(ranked.effect))),
      fall_(fallOf(ranked, before)),
      reason_(typeset(ranked.reason)),
      confidence_(ranked.confidence)
{
    setTitle(title_);
    setDescription(speaksFor() ? whole(100.0 * confidence_) + " % sure. "
                                     + (fall_.isEmpty() ? juce::String() : fall_ + ". ") + reason_
                               : juce::String("Takes nothing away."));
    add_.setTitle("Add " + words(effectTitle(ranked.effect)));
    add_.setTooltip("Adds this effect to the model and fits again");
    add_.onClick = std::move(added);
    addAndMakeVisible(add_);
}

juce::AttributedString CandidateCard::body() const
{
    juce::AttributedString text;
    text.setLineSpacing(2.0f);
    if (fall_.isNotEmpty())
        text.append(fall_ + "\n", juce::Font(13.0f), look::palette().dim);
    text.append(reason_, juce::Font(bodyHeight), look::palette().text);
    return text;
}

int CandidateCard::heightFor(int width) const
{
    if (!speaksFor())
        return static_cast<int>(headHeight + sureHeight) + 18;
    return static_cast<int>(headHeight + sureHeight
                            + heightOf(body(), static_cast<float>(width) - 2.0f * margin - 2.0f))
           + 24;
}

void CandidateCard::paint(juce::Graphics& g)
{
    Card::paint(g);
    const auto& colours = look::palette();
    auto area = getLocalBounds().toFloat().reduced(1.0f, 3.0f).reduced(margin, 7.0f);
    auto head = area.removeFromTop(headHeight).withTrimmedRight(80.0f);
    g.setFont(look::heightThatFits(title_, 15.0f, head.getWidth(), 0.0f, false));
    g.setColour(colours.text);
    g.drawText(title_, head, juce::Justification::centredLeft);
    auto sure = area.removeFromTop(sureHeight);
    g.setFont(13.0f);
    g.setColour(colours.dim);
    if (!speaksFor()) {
        g.drawText("Takes nothing away.", sure, juce::Justification::centredLeft);
        return;
    }
    const auto gauge = sure.removeFromLeft(gaugeWidth).withSizeKeepingCentre(gaugeWidth, 6.0f);
    g.drawText(whole(100.0 * confidence_) + " % sure", sure.withTrimmedLeft(8.0f), juce::Justification::centredLeft);
    g.setColour(colours.grid);
    g.fillRoundedRectangle(gauge, 3.0f);
    g.setColour(colours.accent);
    g.fillRoundedRectangle(gauge.withWidth(static_cast<float>(confidence_) * gauge.getWidth()), 3.0f);
    area.removeFromTop(3.0f);
    body().draw(g, area);
}

void CandidateCard::resized() { add_.setBounds(getWidth() - 84, 10, 72, 24); }

TextCard::TextCard(const juce::String& title, const juce::String& text, std::function<void()> selected)
    : Card(std::move(selected)), title_(title), text_(text)
{
    setTitle(title);
    setDescription(text);
}

juce::AttributedString TextCard::body() const
{
    juce::AttributedString text;
    text.setLineSpacing(3.0f);
    text.append(title_ + "\n", juce::Font(15.0f), look::palette().text);
    text.append(text_, juce::Font(bodyHeight), look::palette().text);
    return text;
}

int TextCard::heightFor(int width) const
{
    return static_cast<int>(heightOf(body(), static_cast<float>(width) - 2.0f * margin - 2.0f) + 2.0f * margin);
}

void TextCard::paint(juce::Graphics& g)
{
    Card::paint(g);
    body().draw(g, getLocalBounds().toFloat().reduced(1.0f + margin, margin));
}

}  // namespace excursion::plugin
