// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plots/Plot.h"
#include "Plugin/Juce.h"

namespace excursion::plugin {

/// Draws a plot as the report draws it: one colour a role, bands as shades, the key above, and under the mouse what the
/// lines say there.
class PlotView : public juce::Component {
public:
    void show(Plot);
    const Plot& plot() const { return plot_; }

    void paint(juce::Graphics&) override;
    void mouseMove(const juce::MouseEvent& event) override { follow(event.position); }
    void mouseExit(const juce::MouseEvent&) override { follow({}); }

private:
    struct Range {
        double least = 0.0, most = 1.0;
        bool logarithmic = false;
        double share(double value) const;  ///< 0 at least, 1 at most
        double value(double share) const;
    };
    struct Tick {
        double value;
        juce::String text;
    };

    static Range rangeOf(const Plot&, const Axis&, bool across);
    static std::vector<Tick> ticksOf(const Axis&, const Range&, int most);
    juce::Point<float> place(double x, double y) const;
    void follow(juce::Point<float>);
    void drawGrid(juce::Graphics&) const;
    void drawSeries(juce::Graphics&, const Series&) const;
    void drawKey(juce::Graphics&, juce::Rectangle<float>) const;
    void drawReading(juce::Graphics&) const;

    Plot plot_;
    Range across_, up_;
    juce::Rectangle<float> area_;
    juce::Point<float> mouse_;
};

}  // namespace excursion::plugin
