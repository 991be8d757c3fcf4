// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/PlotScale.h"

namespace excursion::plugin {

/// A plot within a rectangle, as the report draws it: one colour a role, bands as shades, the key above.
class PlotPicture {
public:
    /// @param room  kept free at the right of the title
    PlotPicture(const Plot&, const AxisRange& across, const AxisRange& up, juce::Rectangle<float> place, float room);

    void paint(juce::Graphics&) const;
    const juce::Rectangle<float>& area() const { return area_; }  ///< between the axes
    const std::vector<AxisLabel>& labels(bool across) const { return across ? acrossLabels_ : upLabels_; }
    juce::Point<float> at(double x, double y) const;

private:
    struct Entry {
        const Series* series;
        juce::String text;
        juce::Rectangle<float> place;
    };
    void layOutKey(juce::Rectangle<float>&);
    void drawAxes(juce::Graphics&) const;
    void drawBand(juce::Graphics&, const Series&) const;
    void drawLine(juce::Graphics&, const Series&) const;
    bool drawable(const Series&, std::size_t k) const;

    const Plot& plot_;
    AxisRange across_, up_;
    juce::Rectangle<float> title_, upTitle_, acrossTitle_, area_;
    std::vector<Entry> key_;
    std::vector<AxisLabel> acrossLabels_, upLabels_;
};

}  // namespace excursion::plugin
