// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/PlotPicture.h"

#include <functional>
#include <memory>
#include <optional>

namespace excursion::plugin {

/// A plot that a person reads: under the mouse, or the arrow keys, what the lines say there; drawing a frame zooms in,
/// the wheel zooms about the mouse (with Shift up and down), dragging with Ctrl moves, a double click or Home shows all
/// again. A right click, the button in the corner, or Return offers the picture as PNG or SVG and the numbers as CSV.
class PlotView : public juce::Component, public juce::SettableTooltipClient {
public:
    PlotView();
    ~PlotView() override;

    /// A zoom is kept while title and axes stay the same.
    void show(Plot);
    const Plot& plot() const { return plot_; }
    Plot seen() const;  ///< the plot with the ranges as they are zoomed

    const AxisRange& range(bool across) const { return across ? across_ : up_; }
    std::vector<AxisLabel> labels(bool across) const;
    bool zoomed() const { return across_ != wholeAcross_ || up_ != wholeUp_; }
    void zoom(const AxisRange& across, const AxisRange& up);
    void showAll();

    /// Writes what is seen, by the file's ending: .png, .svg or .csv. Throws Error (input) when the file cannot be
    /// written, (usage) for another ending, (numerical) when gnuplot is missing, which draws the SVG.
    void save(const juce::File&) const;
    /// As if the file dialog had been given that name: the ending is added, and told() says what came of it.
    void saveAs(const juce::File&, const juce::String& ending) const;
    /// What is read at the mouse or the cursor, a line each: the place, then a line a series. Empty: nothing.
    juce::StringArray reading() const;
    void putCursor(double x);  ///< as if the mouse were there

    /// told how a picture was saved, or why it was not
    std::function<void(const juce::String&, bool trouble)> told;

    void paint(juce::Graphics&) override;
    void resized() override;
    void mouseMove(const juce::MouseEvent&) override;
    void mouseExit(const juce::MouseEvent&) override;
    void mouseDown(const juce::MouseEvent&) override;
    void mouseDrag(const juce::MouseEvent&) override;
    void mouseUp(const juce::MouseEvent&) override;
    void mouseDoubleClick(const juce::MouseEvent&) override { showAll(); }
    void mouseWheelMove(const juce::MouseEvent&, const juce::MouseWheelDetails&) override;
    bool keyPressed(const juce::KeyPress&) override;
    void focusLost(FocusChangeType) override;
    void offer();  ///< the menu

private:
    std::unique_ptr<juce::AccessibilityHandler> createAccessibilityHandler() override;
    PlotPicture picture() const;
    juce::Point<double> sharesAt(juce::Point<float>) const;
    void zoomAbout(juce::Point<double> shares, double factor, bool across, bool up);
    void choose(const juce::String& ending);
    void drawReading(juce::Graphics&, const PlotPicture&) const;
    std::size_t nearest(const Series&, double x) const;

    Plot plot_;
    AxisRange wholeAcross_, wholeUp_, across_, up_;
    AxisRange draggedAcross_, draggedUp_;  ///< as they were when a drag with Ctrl began
    juce::Point<double> from_;
    juce::Rectangle<float> frame_;  ///< that is being drawn
    std::optional<double> cursor_;  ///< x
    juce::TextButton menu_;
    std::unique_ptr<juce::FileChooser> chooser_;
};

}  // namespace excursion::plugin
