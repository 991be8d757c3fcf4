// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/PlotGrid.h"

#include "Plugin/Look.h"

#include <algorithm>

namespace excursion::plugin {

PlotGrid::PlotGrid(const juce::String& title, bool byColumn) : byColumn_(byColumn)
{
    setTitle(title);
    back_.setTitle(title + ", earlier plots");
    on_.setTitle(title + ", further plots");
    back_.setTooltip("Earlier plots");
    on_.setTooltip("Further plots");
    back_.onClick = [this] { turnTo(page_ - 1); };
    on_.onClick = [this] { turnTo(page_ + 1); };
    where_.setJustificationType(juce::Justification::centred);
    where_.setFont(juce::Font(13.0f));
    look::setTone(where_, look::Tone::dim);
    for (juce::Component* one : std::initializer_list<juce::Component*> {&back_, &where_, &on_})
        addChildComponent(one);
    back_.setExplicitFocusOrder(1000);
    on_.setExplicitFocusOrder(1001);
}

void PlotGrid::show(std::vector<Plot> plots)
{
    while (views_.size() > plots.size())
        views_.pop_back();
    while (views_.size() < plots.size()) {
        views_.push_back(std::make_unique<PlotView>());
        views_.back()->setExplicitFocusOrder(static_cast<int>(views_.size()));
        views_.back()->told = [this](const juce::String& text, bool trouble) {
            if (told)
                told(text, trouble);
        };
        addChildComponent(*views_.back());
    }
    for (std::size_t k = 0; k < plots.size(); ++k)
        views_[k]->show(std::move(plots[k]));
    resized();
}

void PlotGrid::turnTo(int page)
{
    page_ = std::clamp(page, 0, pages_ - 1);
    resized();
}

void PlotGrid::resized()
{
    auto area = getLocalBounds();
    const int count = static_cast<int>(views_.size());
    const int most = std::max(1, area.getWidth() / leastWidth);
    // The grid with the largest plots that lie, of those with plots that can be read; otherwise the fullest one.
    int columns = 1, rows = 1;
    double best = -1.0;
    for (int c = 1; c <= std::min(most, std::max(1, count)); ++c) {
        const int needed = (count + c - 1) / std::max(1, c);
        const int possible = std::max(
            1, (area.getHeight() - (c * std::max(1, area.getHeight() / leastHeight) < count ? 26 : 0)) / leastHeight);
        const int r = std::clamp(needed, 1, possible);
        const double shown = std::min(count, c * r), width = area.getWidth() / static_cast<double>(c),
                     height = area.getHeight() / static_cast<double>(r);
        const double worth = shown * 1e4 + std::min(width, 1.7 * height);
        if (worth > best) {
            best = worth;
            columns = c;
            rows = r;
        }
    }
    const int each = columns * rows;
    pages_ = std::max(1, (count + each - 1) / each);
    page_ = std::clamp(page_, 0, pages_ - 1);
    const bool turning = pages_ > 1;
    for (juce::Component* one : std::initializer_list<juce::Component*> {&back_, &where_, &on_})
        one->setVisible(turning);
    if (turning) {
        auto foot = area.removeFromBottom(24).reduced(4, 0);
        area.removeFromBottom(2);
        back_.setBounds(foot.removeFromLeft(32));
        on_.setBounds(foot.removeFromRight(32));
        back_.setEnabled(page_ > 0);
        on_.setEnabled(page_ + 1 < pages_);
        where_.setText(juce::String(page_ + 1) + " of " + juce::String(pages_), juce::dontSendNotification);
        where_.setBounds(foot);
    }
    for (int k = 0; k < count; ++k) {
        auto& view = *views_[static_cast<std::size_t>(k)];
        const int place = k - page_ * each;
        view.setVisible(place >= 0 && place < each);
        const int column = byColumn_ ? place / rows : place % columns, row = byColumn_ ? place % rows : place / columns;
        view.setBounds(area.getX() + column * area.getWidth() / columns, area.getY() + row * area.getHeight() / rows,
                       area.getWidth() / columns, area.getHeight() / rows);
    }
}

}  // namespace excursion::plugin
