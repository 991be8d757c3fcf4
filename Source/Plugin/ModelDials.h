// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/AnyModel.h"
#include "Plugin/Dials.h"
#include "Plugin/Parameters.h"

#include <memory>
#include <utility>
#include <vector>

namespace excursion::plugin {

/// The numbers and the effects of the Linearize page, as dials and switches. A model is shown with those that do
/// something to it. All on the message thread.
class ModelDials {
public:
    ModelDials(Parameters&, History*);

    std::vector<juce::Component*> parts();  ///< in the order of Tab
    void showModel(const AnyModel&);
    void enterFullScale(double volts) { dials_.front().second->enter(volts); }  ///< as if a person had
    /// What a host has moved. @returns true if they are to be placed anew
    bool follow();

    int lines(int width) const;  ///< that they take
    /// Takes their lines from the top of an area.
    /// @param row  px, height of a line
    void place(juce::Rectangle<int>& area, int row);

private:
    bool statesAmplifier() const;
    std::vector<std::pair<juce::ToggleButton*, juce::ToggleButton*>> rows(int width) const;

    Parameters& parameters_;
    ChoiceBox couplingOrder_;
    /// each behind its title
    std::vector<std::pair<std::unique_ptr<juce::Label>, std::unique_ptr<NumberDial>>> dials_;
    std::vector<std::unique_ptr<OnOffButton>> switches_;
};

}  // namespace excursion::plugin
