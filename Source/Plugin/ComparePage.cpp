// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/ComparePage.h"

#include "Plots/Engineering.h"
#include "Plots/Plots.h"
#include "Plots/Words.h"
#include "Plugin/Look.h"

#include <algorithm>
#include <cmath>

namespace excursion::plugin {
namespace {

/// The items of a list; what was chosen stays chosen as far as it can.
void fill(juce::ComboBox& list, const juce::StringArray& items, int otherwise)
{
    const int before = list.getSelectedItemIndex();
    list.clear(juce::dontSendNotification);
    list.addItemList(items, 1);
    list.setSelectedItemIndex(before >= 0 && before < items.size() ? before : otherwise, juce::dontSendNotification);
}

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
    for (auto* list : {&rung_, &channel_, &level_}) {
        list->onChange = [this] { draw(); };
        addAndMakeVisible(list);
    }
    addAndMakeVisible(error_);
    addAndMakeVisible(spectrum_);
    addAndMakeVisible(wave_);
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
    fill(rung_, rungs, rungs.size() - 1);
    if (rungs.size() != before)
        rung_.setSelectedItemIndex(rungs.size() - 1, juce::dontSendNotification);
    fill(channel_, channels, 0);
    fill(level_, levels, levels.size() - 1);
    draw();
}

void ComparePage::draw()
{
    const auto shown = [](const juce::ComboBox& list) {
        return static_cast<std::size_t>(std::max(0, list.getSelectedItemIndex()));
    };
    residuals_.clear();
    spectrum_.show({});
    wave_.show({});
    if (!findings_ || findings_->file.ladder.rungs.empty()) {
        error_.setText("Open or measure a take first.", juce::dontSendNotification);
        resized();
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
    spectrum_.show(std::move(spectrum));
    const bool last = shown(rung_) + 1 == ladder.rungs.size();
    if (last && level < findings_->waveforms.size() && shown(channel_) < findings_->waveforms[level].size()) {
        wave_.show(wavePlot(findings_->waveforms[level][shown(channel_)]));
    } else if (const auto plots = responsePlots(ladder, findings_->file.responses); !plots.empty()) {
        wave_.show(plots[std::min(plots.size() - 1, shown(channel_))]);
    }
    for (auto& plot : residualPlots(comparison, nullptr)) {
        residuals_.push_back(std::make_unique<PlotView>());
        plot.key = false;
        residuals_.back()->show(std::move(plot));
        addAndMakeVisible(*residuals_.back());
    }
    resized();
}

void ComparePage::paint(juce::Graphics& g)
{
    if (residuals_.empty() && findings_ && !findings_->file.ladder.rungs.empty()) {
        g.setColour(look::dim);
        g.setFont(13.0f);
        g.drawFittedText("Residual force and voltage need a channel that tells the displacement, velocity or "
                         "acceleration, and the current.",
                         getLocalBounds().removeFromRight(getWidth() * 2 / 5).reduced(20), juce::Justification::centred,
                         3);
    }
}

void ComparePage::resized()
{
    auto area = getLocalBounds();
    auto head = area.removeFromTop(30);
    for (auto* list : {&rung_, &channel_, &level_}) {
        list->setBounds(head.removeFromLeft(list == &rung_ ? 260 : 150));
        head.removeFromLeft(8);
    }
    error_.setBounds(head);
    area.removeFromTop(8);
    auto right = area.removeFromRight(area.getWidth() * 2 / 5);
    area.removeFromRight(6);
    spectrum_.setBounds(area.removeFromTop(area.getHeight() * 3 / 5));
    area.removeFromTop(6);
    wave_.setBounds(area);
    const int columns = residuals_.size() > 3 ? 2 : 1,
              rows = std::max(1, (static_cast<int>(residuals_.size()) + columns - 1) / columns);
    for (std::size_t k = 0; k < residuals_.size(); ++k) {
        // Column by column: the curves of the force in one, those of the voltage in the other.
        const int column = static_cast<int>(k) / rows, row = static_cast<int>(k) % rows;
        residuals_[k]->setBounds(right.getX() + column * right.getWidth() / columns,
                                 right.getY() + row * right.getHeight() / rows, right.getWidth() / columns,
                                 right.getHeight() / rows);
    }
}

}  // namespace excursion::plugin
