// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/ComparePage.h"

#include "Engine/Document/Engineering.h"
#include "Plots/Plots.h"
#include "Plots/Words.h"
#include "Plugin/FillList.h"
#include "Plugin/Look.h"

#include <algorithm>
#include <cmath>

namespace excursion::plugin {
namespace {

/// A stretch around the largest swing, as a whole period would be a black bar.
Plot wavePlot(const Waveform& wave)
{
    const auto peak = std::max_element(wave.measured.begin(), wave.measured.end(),
                                       [](double a, double b) { return std::abs(a) < std::abs(b); });
    const auto reach = static_cast<std::ptrdiff_t>(0.02 * wave.sampleRate);
    const auto middle = peak - wave.measured.begin(), length = static_cast<std::ptrdiff_t>(wave.measured.size());
    const auto from = std::clamp<std::ptrdiff_t>(middle - reach, 0, std::max<std::ptrdiff_t>(0, length - 2 * reach)),
               to = std::min(length, from + 2 * reach);
    const auto unit = displayUnit(std::abs(*peak), wave.unit);
    Plot plot;
    plot.x = {"time", "ms", false, 0.0, 0.0, {}};
    plot.y = {std::string(name(wave.quantity)), unit.unit, false, 0.0, 0.0, {}};
    plot.series = {{"measured", Role::measured, {}, {}, {}, {}, Series::Shape::line, 0},
                   {"model", Role::model, {}, {}, {}, {}, Series::Shape::line, 0},
                   {"error", Role::error, {}, {}, {}, {}, Series::Shape::line, 0}};
    for (auto n = from; n < to; ++n) {
        const auto k = static_cast<std::size_t>(n);
        const double values[] {wave.measured[k], wave.model[k], wave.measured[k] - wave.model[k]};
        for (std::size_t s = 0; s < 3; ++s) {
            plot.series[s].x.push_back(1e3 * static_cast<double>(n) / wave.sampleRate);
            plot.series[s].y.push_back(values[s] * unit.factor);
        }
    }
    return plot;
}

}  // namespace

ComparePage::ComparePage(Window& window) : Page(window)
{
    for (auto* list : {&rung_, &channel_, &level_})
        list->onChange = [this] { draw(); };
    rung_.setTitle("Model");
    rung_.setTooltip("Which rung of the ladder is compared");
    channel_.setTitle("Channel");
    level_.setTitle("Level");
    overlay_.setTooltip("Draws the errors of all rungs into one picture, and what was missing at first");
    overlay_.setTitle("All rungs in one picture");
    overlay_.onClick = [this] { draw(); };
    error_.setFont(juce::Font(14.0f));
    error_.setBorderSize({1, 0, 1, 0});
    spectrum_.getProperties().set("empty", "Open or measure a take first.");
    wave_.getProperties().set("empty", "Of the last rung a stretch of time is drawn here.");
    const auto tell = [this](const juce::String& text, bool trouble) { window_.tell(text, trouble); };
    spectrum_.told = tell;
    wave_.told = tell;
    residuals_.told = tell;
    add({&rung_, &channel_, &level_, &overlay_, &error_, &spectrum_, &wave_, &residuals_});
}

void ComparePage::show(const std::shared_ptr<const Findings>& fresh)
{
    findings_ = fresh;
    const auto& findings = *fresh;
    const auto& ladder = findings.file.ladder;
    const int before = rung_.getNumItems();
    juce::StringArray rungs, channels, levels;
    for (std::size_t k = 0; k < ladder.rungs.size(); ++k)
        rungs.add(words(rungTitle(ladder, k)));
    if (!ladder.rungs.empty()) {
        for (const auto& channel : ladder.rungs.back().comparison.channels)
            channels.add(words(capitalized(titleOf(channel))));
        for (const double level : ladder.rungs.back().comparison.levels)
            levels.add(level > 0.0 ? words(nominal(level, "V")) + " rms" : "the take");
    }
    fillList(rung_, rungs, rungs.size() - 1);
    if (rungs.size() != before)
        rung_.setSelectedItemIndex(rungs.size() - 1, juce::dontSendNotification);
    fillList(channel_, channels, 0);
    fillList(level_, levels, levels.size() - 1);
    draw();
}

void ComparePage::draw()
{
    const auto shown = [](const juce::ComboBox& list) {
        return static_cast<std::size_t>(std::max(0, list.getSelectedItemIndex()));
    };
    if (!findings_ || findings_->file.ladder.rungs.empty()) {
        spectrum_.show({});
        wave_.show({});
        residuals_.show({});
        error_.setText("Open or measure a take first.", juce::dontSendNotification);
        repaint();
        return;
    }
    const auto& ladder = findings_->file.ladder;
    const auto& comparison = ladder.rungs[shown(rung_)].comparison;
    const auto& channel = comparison.channels[shown(channel_)];
    const auto level = shown(level_);
    const auto& error = channel.byLevel[level];
    error_.setText("Error " + words(decibels(error.db))
                       + (error.noiseFloorDb ? ", noise " + words(decibels(*error.noiseFloorDb)) : juce::String()),
                   juce::dontSendNotification);
    auto spectrum = spectrumPlot(channel.spectrumByLevel[level], channel.unit);
    double most = -1e9;
    for (const double y : spectrum.series.front().y)
        most = std::isfinite(y) ? std::max(most, y) : most;
    spectrum.y.most = 10.0 * std::ceil(most / 10.0 + 0.1);
    spectrum.y.least = spectrum.y.most - 130.0;
    const bool overlaid = overlay_.getToggleState() && ladder.rungs.size() > 1;
    if (overlaid)
        overlayErrors(spectrum, ladder, shown(rung_), shown(channel_), level);
    spectrum_.show(std::move(spectrum));
    const bool last = shown(rung_) + 1 == ladder.rungs.size();
    if (last && level < findings_->waveforms.size() && shown(channel_) < findings_->waveforms[level].size()) {
        wave_.show(wavePlot(findings_->waveforms[level][shown(channel_)]));
    } else if (const auto plots = responsePlots(ladder, findings_->file.responses); !plots.empty()) {
        wave_.show(plots[std::min(plots.size() - 1, shown(channel_))]);
    } else {
        wave_.show({});
    }
    const bool before = overlaid && shown(rung_) > 0;
    auto missing = before ? residualPlots(ladder.rungs.front().comparison, &comparison)
                          : residualPlots(comparison, nullptr);
    for (auto& plot : missing)
        plot.key = before;
    residuals_.show(std::move(missing));
    repaint();
}

void ComparePage::paint(juce::Graphics& g)
{
    if (residuals_.empty() && findings_ && !findings_->file.ladder.rungs.empty()) {
        g.setColour(look::palette().dim);
        g.setFont(14.0f);
        g.drawFittedText("Residual force and voltage need a channel that tells the displacement, velocity or "
                         "acceleration, and the current.",
                         residuals_.getBounds().reduced(20), juce::Justification::centred, 5, 1.0f);
    }
}

void ComparePage::resized()
{
    auto area = getLocalBounds();
    auto head = area.removeFromTop(28);
    const bool wide = getWidth() >= 960;
    rung_.setBounds(head.removeFromLeft(wide ? 290 : 260));
    head.removeFromLeft(8);
    for (auto* list : {&channel_, &level_}) {
        list->setBounds(head.removeFromLeft(140));
        head.removeFromLeft(8);
    }
    overlay_.setBounds(head.removeFromLeft(104));
    head.removeFromLeft(8);
    if (!wide) {  // a line of its own
        area.removeFromTop(2);
        head = area.removeFromTop(20);
    }
    error_.setBounds(head);
    area.removeFromTop(6);
    residuals_.setBounds(area.removeFromRight(area.getWidth() * 2 / 5));
    area.removeFromRight(6);
    spectrum_.setBounds(area.removeFromTop(area.getHeight() * 11 / 20));
    area.removeFromTop(6);
    wave_.setBounds(area);
}

}  // namespace excursion::plugin
