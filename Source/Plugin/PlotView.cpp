// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/PlotView.h"

#include "Plugin/Look.h"
#include "Plugin/Text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace excursion::plugin {
namespace {

juce::Colour colourOf(Role role)
{
    switch (role) {
    case Role::measured: return juce::Colour(0xffe6ebf0);
    case Role::model: return juce::Colour(0xff56b4e9);
    case Role::error: return juce::Colour(0xffe69f00);
    case Role::noise: return juce::Colour(0xff8793a0);
    case Role::before: return juce::Colour(0xffe69f00);
    case Role::after: return juce::Colour(0xff2bc48a);
    case Role::reference: return juce::Colour(0xff8793a0);
    }
    return look::text;
}

/// With as many digits as tell neighbours apart that are `step` from each other.
juce::String number(double value, double step)
{
    const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 6);
    return decimals == 0 ? whole(value) : juce::String(value, decimals);
}

}  // namespace

double PlotView::Range::share(double value) const
{
    return logarithmic ? std::log(value / least) / std::log(most / least) : (value - least) / (most - least);
}

double PlotView::Range::value(double share) const
{
    return logarithmic ? least * std::pow(most / least, share) : least + share * (most - least);
}

PlotView::Range PlotView::rangeOf(const Plot& plot, const Axis& axis, bool across)
{
    Range range {axis.least, axis.most, axis.logarithmic};
    if (axis.least < axis.most)
        return range;
    range.least = std::numeric_limits<double>::infinity();
    range.most = -range.least;
    const auto include = [&](double value) {
        if (std::isfinite(value) && (!axis.logarithmic || value > 0.0)) {
            range.least = std::min(range.least, value);
            range.most = std::max(range.most, value);
        }
    };
    for (const auto& series : plot.series)
        for (const auto* values : across ? std::array {&series.x, &series.x, &series.x}
                                         : std::array {&series.y, &series.lower, &series.upper})
            for (const double value : *values)
                include(value);
    if (!(range.least <= range.most))
        return {axis.logarithmic ? 0.1 : 0.0, 1.0, axis.logarithmic};
    if (range.least == range.most)
        range = axis.logarithmic ? Range {range.least / 2.0, range.most * 2.0, true}
                                 : Range {range.least - 1.0, range.most + 1.0, false};
    if (!across && !axis.logarithmic) {
        const double room = 0.06 * (range.most - range.least);
        range.least -= room;
        range.most += room;
    }
    return range;
}

std::vector<PlotView::Tick> PlotView::ticksOf(const Axis& axis, const Range& range, int most)
{
    std::vector<Tick> ticks;
    if (!axis.names.empty()) {
        for (std::size_t k = 0; k < axis.names.size(); ++k)
            ticks.push_back({static_cast<double>(k), words(axis.names[k])});
        return ticks;
    }
    if (range.logarithmic) {
        const bool many = std::log10(range.most / range.least) > 0.6 * most;
        for (int decade = static_cast<int>(std::floor(std::log10(range.least)));
             decade <= std::ceil(std::log10(range.most)); ++decade)
            for (const int digit : {1, 2, 5}) {
                const double value = digit * std::pow(10.0, decade);
                if (value >= range.least * 0.999 && value <= range.most * 1.001 && (digit == 1 || !many))
                    ticks.push_back({value, value >= 1e3 ? number(value / 1e3, 1.0) + "k"
                                                         : number(value, value >= 1.0 ? 1.0 : value)});
            }
        return ticks;
    }
    const double rough = (range.most - range.least) / std::max(1, most),
                 decade = std::pow(10.0, std::floor(std::log10(rough)));
    const double step = decade
                        * (rough / decade <= 1.0   ? 1.0
                           : rough / decade <= 2.0 ? 2.0
                           : rough / decade <= 5.0 ? 5.0
                                                   : 10.0);
    for (double value = std::ceil(range.least / step - 1e-9) * step; value <= range.most + 1e-9 * step; value += step)
        ticks.push_back({value, number(std::abs(value) < 1e-9 * step ? 0.0 : value, step)});
    return ticks;
}

void PlotView::show(Plot plot)
{
    plot_ = std::move(plot);
    across_ = rangeOf(plot_, plot_.x, true);
    up_ = rangeOf(plot_, plot_.y, false);
    repaint();
}

juce::Point<float> PlotView::place(double x, double y) const
{
    return {area_.getX() + static_cast<float>(std::clamp(across_.share(x), -1.0, 2.0)) * area_.getWidth(),
            area_.getBottom() - static_cast<float>(std::clamp(up_.share(y), -1.0, 2.0)) * area_.getHeight()};
}

void PlotView::follow(juce::Point<float> where)
{
    mouse_ = where;
    repaint();
}

void PlotView::drawGrid(juce::Graphics& g) const
{
    g.setFont(11.5f);
    float free = -1e9f;  // labels do not run into each other
    for (const auto& tick : ticksOf(plot_.x, across_, std::max(3, static_cast<int>(area_.getWidth() / 60.0f)))) {
        const float x = place(tick.value, up_.least).x;
        g.setColour(look::grid);
        g.drawVerticalLine(juce::roundToInt(x), area_.getY(), area_.getBottom());
        if (x - 20.0f < free)
            continue;
        free = x + 14.0f;
        g.setColour(look::dim);
        g.drawText(tick.text, juce::Rectangle<float>(x - 30.0f, area_.getBottom() + 2.0f, 60.0f, 14.0f),
                   juce::Justification::centred);
    }
    for (const auto& tick : ticksOf(plot_.y, up_, std::max(3, static_cast<int>(area_.getHeight() / 32.0f)))) {
        const float y = place(across_.least, tick.value).y;
        g.setColour(look::grid);
        g.drawHorizontalLine(juce::roundToInt(y), area_.getX(), area_.getRight());
        g.setColour(look::dim);
        g.drawText(tick.text, juce::Rectangle<float>(area_.getX() - 48.0f, y - 7.0f, 44.0f, 14.0f),
                   juce::Justification::right);
    }
}

void PlotView::drawSeries(juce::Graphics& g, const Series& series) const
{
    const auto colour = colourOf(series.role);
    const auto count = std::min(series.x.size(), series.y.size());
    const auto drawable = [&](std::size_t k) {
        return std::isfinite(series.x[k]) && std::isfinite(series.y[k]) && (!across_.logarithmic || series.x[k] > 0.0)
               && (!up_.logarithmic || series.y[k] > 0.0);
    };
    if (series.lower.size() == count && series.upper.size() == count && count > 1) {
        // A quadrilateral from point to point: the rasterizer leaves holes in one polygon round the whole band.
        juce::Path band;
        std::size_t before = count;
        for (std::size_t k = 0; k < count; ++k) {
            if (!drawable(k) || !std::isfinite(series.lower[k]) || !std::isfinite(series.upper[k]))
                continue;
            if (before < k)
                band.addQuadrilateral(
                    place(series.x[before], series.lower[before]).x, place(series.x[before], series.lower[before]).y,
                    place(series.x[before], series.upper[before]).x, place(series.x[before], series.upper[before]).y,
                    place(series.x[k], series.upper[k]).x, place(series.x[k], series.upper[k]).y,
                    place(series.x[k], series.lower[k]).x, place(series.x[k], series.lower[k]).y);
            before = k;
        }
        g.setColour(colour.withAlpha(0.18f));
        g.fillPath(band);
    }
    juce::Path path;
    bool down = false;
    g.setColour(colour);
    for (std::size_t k = 0; k < count; ++k) {
        if (!drawable(k)) {
            down = false;
            continue;
        }
        const auto point = place(series.x[k], series.y[k]);
        down ? path.lineTo(point) : path.startNewSubPath(point);
        down = true;
        if (series.shape == Series::Shape::pointsAndLine)
            g.fillEllipse(juce::Rectangle<float>(7.0f, 7.0f).withCentre(point));
    }
    const juce::PathStrokeType stroke(series.role == Role::measured || series.role == Role::after ? 2.0f : 1.5f);
    if (series.role == Role::noise || series.role == Role::reference || series.dash > 1) {
        const float dashes[] {5.0f, 4.0f};
        stroke.createDashedStroke(path, path, dashes, 2);
        g.fillPath(path);
    } else {
        g.strokePath(path, stroke);
    }
}

void PlotView::drawKey(juce::Graphics& g, juce::Rectangle<float> row) const
{
    g.setFont(12.0f);
    for (const auto& series : plot_.series) {
        if (series.title.empty())
            continue;
        const auto text = words(series.title);
        const float width = g.getCurrentFont().getStringWidthFloat(text) + 30.0f;
        if (row.getWidth() < width)
            return;
        auto entry = row.removeFromLeft(width);
        g.setColour(colourOf(series.role));
        g.fillRect(entry.removeFromLeft(14.0f).withSizeKeepingCentre(14.0f, 2.5f));
        g.setColour(look::dim);
        g.drawText(text, entry.withTrimmedLeft(5.0f), juce::Justification::left);
    }
}

void PlotView::drawReading(juce::Graphics& g) const
{
    if (!area_.contains(mouse_))
        return;
    g.setColour(look::dim);
    g.drawVerticalLine(juce::roundToInt(mouse_.x), area_.getY(), area_.getBottom());
    const double x = across_.value((mouse_.x - area_.getX()) / area_.getWidth());
    juce::StringArray lines {number(x, std::abs(x) < 10.0    ? 0.01
                                       : std::abs(x) < 100.0 ? 0.1
                                                             : 1.0)
                             + " " + words(plot_.x.unit)};
    for (const auto& series : plot_.series) {
        if (series.title.empty() || series.x.empty())
            continue;
        std::size_t nearest = 0;
        for (std::size_t k = 1; k < std::min(series.x.size(), series.y.size()); ++k)
            if (std::abs(across_.share(series.x[k]) - across_.share(x))
                < std::abs(across_.share(series.x[nearest]) - across_.share(x)))
                nearest = k;
        if (std::isfinite(series.y[nearest]))
            lines.add(words(series.title) + "  " + juce::String(series.y[nearest], 2) + " " + words(plot_.y.unit));
    }
    g.setFont(12.0f);
    float width = 0.0f;
    for (const auto& line : lines)
        width = std::max(width, g.getCurrentFont().getStringWidthFloat(line) + 14.0f);
    auto box = juce::Rectangle<float>(mouse_.x + 10.0f, area_.getY() + 4.0f, width,
                                      6.0f + 15.0f * static_cast<float>(lines.size()));
    if (box.getRight() > area_.getRight())
        box.setX(mouse_.x - 10.0f - width);
    g.setColour(look::background.withAlpha(0.9f));
    g.fillRoundedRectangle(box, 3.0f);
    g.setColour(look::text);
    box.reduce(7.0f, 3.0f);
    for (const auto& line : lines)
        g.drawText(line, box.removeFromTop(15.0f), juce::Justification::left);
}

void PlotView::paint(juce::Graphics& g)
{
    auto panel = getLocalBounds().toFloat().reduced(2.0f);
    g.setColour(look::panel);
    g.fillRoundedRectangle(panel, 4.0f);
    if (plot_.series.empty())
        return;
    panel.reduce(10.0f, 6.0f);
    const auto label = [](const Axis& axis) {
        return words(axis.unit.empty() ? axis.title : axis.title + " (" + axis.unit + ")");
    };
    g.setColour(look::text);
    g.setFont(14.0f);
    if (!plot_.title.empty())
        g.drawText(words(plot_.title), panel.removeFromTop(18.0f), juce::Justification::left);
    auto key = panel.removeFromTop(16.0f);
    g.setFont(12.0f);
    g.setColour(look::dim);
    const auto upTitle = label(plot_.y);
    const auto upWidth = g.getCurrentFont().getStringWidthFloat(upTitle) + 16.0f;
    g.drawText(upTitle, key.removeFromLeft(upWidth), juce::Justification::left);
    if (plot_.key)
        drawKey(g, key);
    g.setFont(12.0f);
    g.setColour(look::dim);
    g.drawText(label(plot_.x), panel.removeFromBottom(15.0f), juce::Justification::centred);
    panel.removeFromBottom(16.0f);
    panel.removeFromTop(4.0f);
    area_ = panel.withTrimmedLeft(44.0f).withTrimmedRight(8.0f);
    drawGrid(g);
    {
        const juce::Graphics::ScopedSaveState inside(g);
        g.reduceClipRegion(area_.getSmallestIntegerContainer().expanded(4));
        for (const auto& series : plot_.series)
            drawSeries(g, series);
    }
    drawReading(g);
}

}  // namespace excursion::plugin
