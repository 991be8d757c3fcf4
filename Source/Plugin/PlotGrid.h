// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/PlotView.h"

#include <memory>
#include <vector>

namespace excursion::plugin {

/// Plots side by side, as many as can be read in the room there is; where that is not all of them, two buttons turn the
/// pages.
class PlotGrid : public juce::Component {
public:
    static constexpr int leastWidth = 210, leastHeight = 138;  ///< px, of a plot that can be read

    /// @param byColumn  the plots that follow each other stand below, not beside each other
    explicit PlotGrid(const juce::String& title, bool byColumn = false);

    void show(std::vector<Plot>);
    bool empty() const { return views_.empty(); }
    const std::vector<std::unique_ptr<PlotView>>& views() const { return views_; }
    void turnTo(int page);
    int pages() const { return pages_; }

    std::function<void(const juce::String&, bool trouble)> told;  ///< see PlotView

    void resized() override;

private:
    bool byColumn_;
    std::vector<std::unique_ptr<PlotView>> views_;
    juce::TextButton back_ {"<"}, on_ {">"};
    juce::Label where_;
    int page_ = 0, pages_ = 1;
};

}  // namespace excursion::plugin
