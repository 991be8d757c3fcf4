// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Page.h"
#include "Plugin/PlotView.h"

#include <memory>
#include <vector>

namespace excursion::plugin {

/// The verdict, what competes for the missing effect with the evidence, a button that adds it, and the ladder as it
/// falls.
class DiagnosePage : public Page {
public:
    explicit DiagnosePage(Window&);
    ~DiagnosePage() override;

    void show(const std::shared_ptr<const Findings>&) override;
    void tick() override;
    void paint(juce::Graphics&) override;
    void resized() override;

    /// As if the button beside that effect had been pressed.
    void add(std::size_t place);

private:
    class Candidate;
    class Advice;
    static constexpr auto noCandidate = static_cast<std::size_t>(-1);  ///< selects the advice
    void select(std::size_t place);

    std::shared_ptr<const Findings> findings_;
    juce::Label verdict_, truth_;
    juce::Viewport list_;
    juce::Component rows_;
    std::unique_ptr<Advice> advice_;
    std::vector<std::unique_ptr<Candidate>> candidates_;
    std::size_t selected_ = 0;
    PlotView evidence_;
    std::vector<std::unique_ptr<PlotView>> falls_;
    juce::TextButton undo_ {"Take the last effect back"}, linearize_ {"Linearize with this model"},
        report_ {"Save the report..."}, reveal_ {"Reveal what was hidden"};
    std::unique_ptr<juce::FileChooser> chooser_;
};

}  // namespace excursion::plugin
