// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/TargetPanel.h"

#include "Engine/Error.h"
#include "Plugin/TargetPlots.h"

#include <nlohmann/json.hpp>

namespace excursion::plugin {
namespace {

constexpr int gap = 6, high = 26;

}  // namespace

TargetPanel::TargetPanel(Window& window)
    : processor_(window.processor()), kind_(processor_.parameters().target(), &window.history())
{
    kind_.box().setTooltip("What the linearized driver is to move like");
    picture_.addItemList({"Laws and distortion", "What the target costs"}, 1);
    picture_.setSelectedItemIndex(0, juce::dontSendNotification);
    picture_.setTitle("Picture");
    picture_.onChange = [this] {
        asked_ = {};
        if (reshaped)
            reshaped();
    };
    words_.setFont(juce::Font(14.0f));
    words_.setBorderSize({1, 0, 1, 0});
    words_.setJustificationType(juce::Justification::topLeft);
    words_.setMinimumHorizontalScale(1.0f);
    words_.setTitle("What the target costs");
    plots_.told = [this](const juce::String& text, bool trouble) {
        if (told)
            told(text, trouble);
    };
    int order = 0;
    const auto add = [this, &order](juce::Component& part) {
        part.setExplicitFocusOrder(++order);
        addAndMakeVisible(part);
    };
    add(kind_.box());
    add(picture_);
    const auto numbers = processor_.parameters().targetNumbers();
    const std::array titles {"f0", "Q", "Volume"};
    for (std::size_t k = 0; k < settings_.size(); ++k) {
        auto& one = settings_[k];
        one.title.setText(titles[k], juce::dontSendNotification);
        one.title.setFont(juce::Font(14.0f));
        one.title.setBorderSize({1, 0, 1, 0});
        one.dial = std::make_unique<NumberDial>(*numbers[k], &window.history());
        add(one.title);
        add(one.dial->slider());
    }
    add(words_);
    add(plots_);
    follow();
}

void TargetPanel::choosePicture(bool target)
{
    picture_.setSelectedItemIndex(target ? 1 : 0, juce::dontSendNotification);
    picture_.onChange();
}

int TargetPanel::head() const
{
    const bool rows = pictured() || processor_.parameters().settings().target.kind != Target::Kind::own;
    return high + gap + (rows ? high + gap : 0);
}

/// What a host has moved; a kind that is another shows other dials.
void TargetPanel::follow()
{
    kind_.follow();
    for (auto& one : settings_)
        one.dial->follow();
    const int kind = kind_.box().getSelectedItemIndex();
    if (std::exchange(shownKind_, kind) == kind)
        return;
    if (reshaped)
        reshaped();
}

/// Of the driver with the effects that are switched on.
void TargetPanel::ask()
{
    const auto recipe = processor_.parameters().recipe();
    auto question = std::pair {processor_.modelVersion(), toJson(recipe).dump()};
    if (question == asked_)
        return;
    asked_ = std::move(question);
    words_.setText("What the target costs is being computed.", juce::dontSendNotification);  // not the one before
    const auto model = withoutOff(processor_.model(), recipe);
    Answer answer;
    answer.controls = controlsOf(recipe, model);
    answer.unit = model.electrical() ? "V" : "N";
    const bool own = recipe.target.kind == Target::Kind::own;
    answer.used = !own && (recipe.mode == Mode::linearize || recipe.mode == Mode::audition);
    if (own)
        answer.controls.target.kind = Target::Kind::resonance;
    forecast_.ask([model, answer, volts = recipe.fullScale]() mutable {
        try {
            answer.told = forecastTarget(model, answer.controls, volts);
        } catch (const Error& error) {
            answer.refusal = std::string(error.what()) + " The own linear part is played.";
        }
        return answer;
    });
}

void TargetPanel::show(const Answer& answer)
{
    if (!answer.told) {
        words_.setText(words(answer.refusal), juce::dontSendNotification);
        plots_.show({});
        return;
    }
    words_.setText(words(wordsOf(*answer.told, answer.unit, answer.used)), juce::dontSendNotification);
    plots_.show(targetPlots(*answer.told, answer.controls, answer.unit));
}

void TargetPanel::tick()
{
    follow();
    if (!pictured())
        return;
    ask();
    if (const auto answer = forecast_.collect())
        show(*answer);
}

void TargetPanel::resized()
{
    auto area = getLocalBounds();
    auto row = area.removeFromTop(high);
    kind_.box().setBounds(row.removeFromLeft(row.getWidth() / 2 - gap / 2));
    row.removeFromLeft(gap);
    picture_.setBounds(row);
    area.removeFromTop(gap);
    const auto kind = processor_.parameters().settings().target.kind;
    const bool box = kind == Target::Kind::closedBox, rows = pictured() || kind != Target::Kind::own;
    for (std::size_t k = 0; k < settings_.size(); ++k) {
        const bool shown = rows && box == (k == 2);
        settings_[k].title.setVisible(shown);
        settings_[k].dial->slider().setVisible(shown);
    }
    words_.setVisible(pictured());
    plots_.setVisible(pictured());
    if (rows) {
        row = area.removeFromTop(high);
        area.removeFromTop(gap);
        for (std::size_t k = 0; k < settings_.size(); ++k) {
            auto& one = settings_[k];
            if (!one.title.isVisible())
                continue;
            auto cell = k == 0 ? row.removeFromLeft(row.getWidth() / 2 - gap / 2) : row;
            if (k == 0)
                row.removeFromLeft(gap);
            one.title.setBounds(cell.removeFromLeft(k == 2 ? 56 : 24));
            one.dial->slider().setBounds(cell);
        }
    }
    if (!pictured())
        return;
    words_.setBounds(area.removeFromTop(getWidth() < 520 ? 72 : 40));
    area.removeFromTop(gap);
    plots_.setBounds(area);
}

}  // namespace excursion::plugin
