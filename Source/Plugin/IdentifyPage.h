// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Dials.h"
#include "Plugin/Page.h"
#include "Plugin/PlotView.h"

#include <memory>
#include <vector>

namespace excursion::plugin {

/// Models of the take that know no physics: a linear one of an order, whole or fractional, made stable and smaller
/// while its response is looked at, and a polynomial one that begins at it and can be sent to the last page.
class IdentifyPage : public Page {
public:
    explicit IdentifyPage(Window&);

    void show(const std::shared_ptr<const Findings>&) override;
    void tick() override;
    void resized() override;

    // As if a person had chosen it.
    void choose(const IdentifyWish&);
    void choose(const ShapeWish&);
    IdentifyWish wish() const;
    ShapeWish shapeWish() const;

private:
    void identify() { session().identify(wish()); }
    void shape();
    void fit();
    void save();
    void follow();
    void note(const Identification&);
    void put(const Identification&);
    void draw();

    juce::ComboBox output_, level_, order_, time_, stabilizing_, reducing_, degree_;
    juce::Label stabilizingTitle_, reducingTitle_, degreeTitle_, facts_, pnlssFacts_;
    Dial alpha_ {juce::Slider::LinearHorizontal, juce::Slider::TextBoxRight},
        reduced_ {juce::Slider::LinearHorizontal, juce::Slider::TextBoxRight};
    juce::ToggleButton unstable_ {"May be unstable"}, plane_ {"Complex plane"};
    juce::TextButton identify_ {"Identify"}, fit_ {"Fit a PNLSS"}, linearize_ {"Linearize with it"},
        save_ {"Save the model..."};
    PlotView gain_, phase_, roots_, steps_;
    std::unique_ptr<juce::FileChooser> chooser_;
    std::shared_ptr<const PreparedTake> take_;
    std::vector<std::string> outputs_;  ///< quantities, in the order of the list
    Identification seen_, noted_;       ///< drawn; known to the history
    bool shaping_ = false;              ///< what is under way is a shape that was asked for here
};

}  // namespace excursion::plugin
