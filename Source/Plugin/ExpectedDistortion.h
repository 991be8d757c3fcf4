// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/PredictedDistortion.h"
#include "Plugin/Forecast.h"
#include "Plugin/PlotView.h"
#include "Plugin/Processor.h"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace excursion::plugin {

/// The distortion that is to be expected as it is and linearized, as a picture and in words: of a driver predicted at
/// 0 dBFS with the recipe as it is set, of a model without physics as its rehearsal has it. All on the message thread.
class ExpectedDistortion {
public:
    ExpectedDistortion();

    PlotView& picture() { return picture_; }
    juce::Label& words() { return words_; }
    void showModel(const AnyModel&);
    /// What is known by now of a driver, and a question if model or recipe are others.
    void followDriver(Processor&);

private:
    void show(const std::vector<double>& frequency, const std::vector<double>& before, const std::vector<double>& after,
              const std::string& title);
    void tell(const juce::String& text) { words_.setText(text, juce::dontSendNotification); }

    PlotView picture_;
    juce::Label words_;
    Forecast<std::optional<PredictedDistortion>> forecast_;
    /// version of the model, and the recipe, that the forecast is of
    std::pair<std::uint64_t, std::string> asked_;
};

}  // namespace excursion::plugin
