// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/TargetForecast.h"
#include "Plugin/Dials.h"
#include "Plugin/Forecast.h"
#include "Plugin/Page.h"
#include "Plugin/PlotGrid.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace excursion::plugin {

/// What a linearized loudspeaker is to move or sound like, and what that costs: its own linear part, another resonance,
/// a closed box, a flat band, or a curve of a file, with response, excursion and voltage before it is used. While the
/// own linear part is played, the picture shows what the resonance as it is set would do. A curve is taken where it is
/// dropped, while its button is seen.
class TargetPanel : public juce::Component, public juce::FileDragAndDropTarget {
public:
    explicit TargetPanel(Window&);

    /// Whether the picture of the target is asked for, which takes all of the panel; else it is as high as head().
    bool pictured() const { return picture_.getSelectedItemIndex() == 1; }
    void choosePicture(bool target);  ///< as if a person had
    int head() const;                 ///< px
    void use(const juce::File&);      ///< a curve; told in the status line where it is none
    std::function<void()> reshaped;   ///< head() or pictured() are others
    std::function<void(const juce::String&, bool trouble)> told;

    void tick();
    void resized() override;
    bool isInterestedInFileDrag(const juce::StringArray&) override;
    void filesDropped(const juce::StringArray& files, int, int) override { use(juce::File(files[0])); }

private:
    struct Answer {
        std::optional<TargetForecast> told;
        std::string refusal;
        PredistortionControls controls;
        std::string unit;
        bool used = false;
    };
    void follow();
    void choose();
    void ask();
    void show(const Answer&);

    Processor& processor_;
    History& history_;
    ChoiceBox kind_;
    juce::ComboBox picture_;
    struct Setting {
        juce::Label title;
        std::unique_ptr<NumberDial> dial;
    };
    std::array<Setting, 5> settings_;  ///< f0, Q, volume, and the ends of a flat band
    juce::TextButton load_ {"Load a curve..."};
    std::unique_ptr<juce::FileChooser> chooser_;
    juce::Label words_;
    PlotGrid plots_ {"Response, excursion and voltage of the target"};
    Forecast<Answer> forecast_;
    std::pair<std::uint64_t, std::string> asked_;  ///< version of the model, and the recipe, that the forecast is of
    int shownKind_ = -1;
};

}  // namespace excursion::plugin
