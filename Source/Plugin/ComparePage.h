// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Page.h"
#include "Plugin/PlotGrid.h"

#include <memory>
#include <vector>

namespace excursion::plugin {

/// Where the model fails: a channel at a level against frequency and time, and what the balances of force and voltage
/// lack.
class ComparePage : public Page {
public:
    explicit ComparePage(Window&);

    void show(const std::shared_ptr<const Findings>&) override;
    void paint(juce::Graphics&) override;
    void resized() override;

private:
    void draw();

    std::shared_ptr<const Findings> findings_;
    juce::ComboBox rung_, channel_, level_;
    juce::Label error_;
    juce::ToggleButton overlay_ {"All rungs"};
    PlotView spectrum_, wave_;
    PlotGrid residuals_ {"Missing force and voltage", true};
};

}  // namespace excursion::plugin
