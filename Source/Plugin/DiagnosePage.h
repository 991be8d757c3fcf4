// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/CandidateCard.h"
#include "Plugin/Page.h"
#include "Plugin/PlotGrid.h"

#include <memory>
#include <vector>

namespace excursion::plugin {

/// The verdict, what competes for the missing effect with the evidence, a button that adds it, and the ladder as it
/// falls.
class DiagnosePage : public Page {
public:
    explicit DiagnosePage(Window&);

    void show(const std::shared_ptr<const Findings>&) override;
    void tick() override;
    void paint(juce::Graphics&) override;
    void resized() override;

    /// As if the button beside that effect had been pressed.
    void addCandidate(std::size_t place);

private:
    static constexpr auto noCandidate = static_cast<std::size_t>(-1);  ///< selects the advice
    void select(std::size_t place);
    void layOutList();
    bool lacksModel() const;  ///< of a take that could have one

    std::shared_ptr<const Findings> findings_;
    juce::Label verdict_, truth_;
    juce::Viewport list_;
    juce::Component rows_;
    std::unique_ptr<TextCard> advice_;
    std::vector<std::unique_ptr<CandidateCard>> candidates_;
    std::size_t selected_ = 0;
    PlotView evidence_;
    PlotGrid falls_ {"How the errors fall"};
    juce::TextButton begin_ {"Fit the first model"}, undo_ {"Take the last effect back"},
        linearize_ {"Linearize with this model"}, save_ {"Save the model..."}, report_ {"Save the report..."},
        reveal_ {"Reveal what was hidden"};
    std::unique_ptr<juce::FileChooser> chooser_;
};

}  // namespace excursion::plugin
