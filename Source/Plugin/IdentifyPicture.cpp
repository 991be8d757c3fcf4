// SPDX-License-Identifier: GPL-3.0-or-later
// How the page Identify is drawn and laid out.
#include "Engine/Document/Engineering.h"
#include "Plots/IdentifiedPlots.h"
#include "Plugin/IdentifyPage.h"
#include "Plugin/Look.h"

namespace excursion::plugin {

void IdentifyPage::draw()
{
    const auto& [linear, pnlss] = seen_;
    if (!linear) {
        for (auto* plot : {&gain_, &phase_, &roots_, &steps_})
            plot->show({});
        facts_.setText(take_ ? "Choose a channel and an order." : "Open or measure a take first.",
                       juce::dontSendNotification);
        pnlssFacts_.setText({}, juce::dontSendNotification);
        return;
    }
    const auto unit = std::string(siUnit(linear->response.output)) + "/" + std::string(siUnit(linear->response.input));
    gain_.show(gainPlot(linear->response.frf, linear->shown, unit));
    phase_.show(phasePlot(linear->response.frf, linear->shown));
    roots_.show(plane_.getToggleState() ? rootsPlanePlot(linear->model, linear->alpha)
                                        : rootsPlot(linear->model, linear->alpha));
    if (pnlss)
        steps_.show(stepsPlot(pnlss->history, pnlss->noiseDb));
    else if (!linear->orders.order.empty())
        steps_.show(orderPlot(linear->orders));
    else
        steps_.show({});
    facts_.setText(words(shortWordsOf(*linear)), juce::dontSendNotification);
    facts_.setTooltip(words(wordsOf(*linear)));
    look::setTone(facts_, linear->stable ? look::Tone::text : look::Tone::warning);
    pnlssFacts_.setText(pnlss ? words(shortWordsOf(*pnlss)) : juce::String(), juce::dontSendNotification);
    pnlssFacts_.setTooltip(pnlss ? words(pnlss->words) : juce::String());
    look::setTone(pnlssFacts_, !pnlss || pnlss->stable ? look::Tone::text : look::Tone::warning);
}

void IdentifyPage::resized()
{
    auto area = getLocalBounds();
    constexpr int gap = 8, high = 28;
    const auto line = [&area](int height) {
        auto taken = area.removeFromTop(height);
        area.removeFromTop(6);
        return taken;
    };
    const auto place = [](juce::Rectangle<int>& row, juce::Component& part, int width) {
        part.setBounds(row.removeFromLeft(width));
        row.removeFromLeft(gap);
    };
    const bool wide = getWidth() >= 960,
               given = time_.getSelectedItemIndex() == static_cast<int>(ModelTime::fractional);
    auto row = line(high);
    if (!wide) {
        identify_.setBounds(row.removeFromRight(84));
        row.removeFromRight(gap);
    }
    place(row, output_, wide ? 150 : 122);
    place(row, level_, wide ? 150 : 112);
    place(row, order_, wide ? 150 : 124);
    place(row, time_, wide ? 180 : 156);
    alpha_.setVisible(given);
    if (wide) {
        if (given)
            place(row, alpha_, std::min(180, row.getWidth() - 260));
        place(row, unstable_, 134);
        place(row, identify_, 110);
    } else {
        alpha_.setBounds(row);
    }
    row = line(high);
    place(row, stabilizingTitle_, 58);
    place(row, stabilizing_, wide ? 170 : 148);
    place(row, reducingTitle_, 52);
    place(row, reducing_, wide ? 190 : 164);
    if (!wide) {
        unstable_.setBounds(row.removeFromRight(134));
        row.removeFromRight(gap);
    }
    reduced_.setBounds(row.withWidth(std::min(row.getWidth(), 260)));
    row = line(high);
    place(row, degreeTitle_, 58);
    place(row, degree_, 108);
    place(row, fit_, 112);
    place(row, linearize_, 142);
    place(row, save_, 142);
    plane_.setBounds(row.removeFromRight(134));
    row = line(20);
    facts_.setBounds(row.removeFromLeft((row.getWidth() - gap) / 2));
    row.removeFromLeft(gap);
    pnlssFacts_.setBounds(row);
    auto left = area.removeFromLeft(area.getWidth() * 11 / 20);
    area.removeFromLeft(6);
    gain_.setBounds(left.removeFromTop(left.getHeight() * 11 / 20));
    left.removeFromTop(6);
    phase_.setBounds(left);
    roots_.setBounds(area.removeFromTop(gain_.getHeight()));
    area.removeFromTop(6);
    steps_.setBounds(area);
}

}  // namespace excursion::plugin
