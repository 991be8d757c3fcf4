// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/TargetPanel.h"

#include "Engine/BlackBox/BoxLinearPart.h"
#include "Engine/Datasheet/KnownScale.h"
#include "Engine/Error.h"
#include "Engine/Import/LevelCurve.h"
#include "Plugin/TargetPlots.h"

#include <nlohmann/json.hpp>

namespace excursion::plugin {
namespace {

constexpr int gap = 6, high = 26;

/// Which of the settings a kind of target has.
bool belongs(std::size_t setting, Target::Kind kind)
{
    switch (kind) {
    case Target::Kind::own:
    case Target::Kind::resonance: return setting < 2;
    case Target::Kind::closedBox: return setting == 2;
    case Target::Kind::flat: return setting > 2;
    default: return false;
    }
}

}  // namespace

TargetPanel::TargetPanel(Window& window)
    : processor_(window.processor()),
      history_(window.history()),
      kind_(processor_.parameters().target(), &window.history())
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
    const std::array titles {"f0", "Q", "Volume", "From", "To"};
    for (std::size_t k = 0; k < settings_.size(); ++k) {
        auto& one = settings_[k];
        one.title.setText(titles[k], juce::dontSendNotification);
        one.title.setFont(juce::Font(14.0f));
        one.title.setBorderSize({1, 0, 1, 0});
        one.dial = std::make_unique<NumberDial>(*numbers[k], &window.history());
        add(one.title);
        add(one.dial->slider());
    }
    load_.setTooltip("Lines of frequency in Hz and dB, as in an .frd; or drop the .frd, .txt or .csv here");
    load_.onClick = [this] { choose(); };
    add(load_);
    add(words_);
    add(plots_);
    follow();
}

void TargetPanel::choose()
{
    chooser_ = std::make_unique<juce::FileChooser>("Load a curve", juce::File(), "*.frd;*.txt;*.csv");
    chooser_->launchAsync(juce::FileBrowserComponent::openMode | juce::FileBrowserComponent::canSelectFiles,
                          [this](const juce::FileChooser& chosen) {
                              if (chosen.getResult() != juce::File())
                                  use(chosen.getResult());
                          });
}

/// What it is not interested in the window takes, as a take.
bool TargetPanel::isInterestedInFileDrag(const juce::StringArray& files)
{
    return load_.isVisible() && files.size() == 1 && juce::File(files[0]).hasFileExtension("frd;txt;csv");
}

void TargetPanel::use(const juce::File& file)
{
    try {
        const auto read = readLevelCurve(file.getFullPathName().toStdString());
        const auto before = processor_.parameters().settings().target.curve, now = targetCurve(read.frequency, read.db);
        const auto put = [this](const ThirdOctaves& curve) {
            processor_.parameters().setCurve(curve);
            processor_.tellHostOfState();
        };
        history_.did(
            "Target curve", [put, before] { put(before); }, [put, now] { put(now); });
        put(now);
        if (told)
            told("The target follows " + file.getFileName() + ".", false);
    } catch (const std::exception& error) {  // no host expects one where a file is dropped
        if (told)
            told(words(error.what()), true);
    }
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
    const auto box = processor_.box();
    const auto loaded = processor_.model(), model = withoutOff(loaded, recipe);
    Answer answer;
    answer.controls = box ? controlsOf(static_cast<const Settings&>(recipe), measuredDisplacement(box->played))
                          : controlsOf(recipe, loaded);
    answer.unit = (box ? box->played.box.input == "voltage" : model.electrical()) ? "V" : "N";
    const bool own = recipe.target.kind == Target::Kind::own;
    answer.used = !own && (recipe.mode == Mode::linearize || recipe.mode == Mode::audition);
    if (own)
        answer.controls.target.kind = Target::Kind::resonance;
    forecast_.ask([model, box, answer, volts = recipe.fullScale](const Progress& progress) mutable {
        try {
            if (box && !box->played.rehearsal)
                answer.refusal = "A model that is not turned around has no target.";
            else if (box)
                answer.told = forecastTarget(box->played.box, box->played.region, box->played.rest,
                                             *box->played.rehearsal, answer.controls, volts, progress);
            else
                answer.told = forecastTarget(model, answer.controls, volts, progress);
            if (answer.told && !box && withKnown(model, {}).motionIsGuessed)
                answer.told = withoutLengths(std::move(*answer.told));
        } catch (const Error& error) {
            if (error.kind() == Error::Kind::cancelled)
                throw;
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
    const bool rows = pictured() || kind != Target::Kind::own,
               curve = kind == Target::Kind::bands || kind == Target::Kind::response;
    load_.setVisible(rows && curve);
    for (std::size_t k = 0; k < settings_.size(); ++k) {
        const bool shown = rows && belongs(k, kind);
        settings_[k].title.setVisible(shown);
        settings_[k].dial->slider().setVisible(shown);
    }
    words_.setVisible(pictured());
    plots_.setVisible(pictured());
    if (rows) {
        row = area.removeFromTop(high);
        area.removeFromTop(gap);
        load_.setBounds(row.withWidth(juce::jmin(160, row.getWidth())));
        for (std::size_t k = 0; k < settings_.size(); ++k) {
            auto& one = settings_[k];
            if (!one.title.isVisible())
                continue;
            const bool first = k == 0 || k == 3;
            auto cell = first ? row.removeFromLeft(row.getWidth() / 2 - gap / 2) : row;
            if (first)
                row.removeFromLeft(gap);
            one.title.setBounds(cell.removeFromLeft(k == 2 ? 56 : k == 3 ? 44 : 24));
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
