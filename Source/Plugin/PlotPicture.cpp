// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/PlotPicture.h"

#include "Plugin/Look.h"
#include "Plugin/Text.h"

#include <algorithm>
#include <cmath>

namespace excursion::plugin {
namespace {

constexpr float titleHeight = 14.0f, textHeight = 12.0f, line = 15.0f, labelGap = 8.0f, swatch = 16.0f;

float widthOf(const juce::String& text, float height = textHeight)
{
    return juce::Font(height).getStringWidthFloat(text);
}

juce::String titleOf(const Axis& axis)
{
    return words(axis.unit.empty() ? axis.title : axis.title + " (" + axis.unit + ")");
}

/// The pattern of a line; none: unbroken. Earlier rungs have one each.
std::vector<float> dashesOf(const Series& series)
{
    switch (series.dash > 1 ? series.dash : series.role == Role::noise || series.role == Role::reference ? 3 : 1) {
    case 1: return {};
    case 2: return {8.0f, 4.0f};
    case 3: return {2.0f, 3.0f};
    case 4: return {8.0f, 3.0f, 2.0f, 3.0f};
    default: return {12.0f, 3.0f, 2.0f, 3.0f, 2.0f, 3.0f};
    }
}

void strokeDashed(juce::Graphics& g, juce::Path path, const Series& series)
{
    const juce::PathStrokeType stroke(series.role == Role::measured || series.role == Role::after ? 2.0f : 1.6f);
    const auto dashes = dashesOf(series);
    if (dashes.empty()) {
        g.strokePath(path, stroke);
        return;
    }
    stroke.createDashedStroke(path, path, dashes.data(), static_cast<int>(dashes.size()));
    g.fillPath(path);
}

}  // namespace

PlotPicture::PlotPicture(const Plot& plot, const AxisRange& across, const AxisRange& up, juce::Rectangle<float> place,
                         float room)
    : plot_(plot), across_(across), up_(up)
{
    place.reduce(10.0f, 6.0f);
    auto head = place.removeFromTop(18.0f);
    title_ = head.withTrimmedRight(room);
    if (plot.title.empty()) {  // then the key begins there
        place.setTop(head.getY());
        auto keyed = place.withTrimmedRight(room);
        const float top = keyed.getY();
        layOutKey(keyed);
        place.removeFromTop(std::max(keyed.getY() - top, 18.0f));
        title_ = {};
    } else {
        layOutKey(place);
    }
    acrossTitle_ = place.removeFromBottom(line);
    place.removeFromBottom(line + 1.0f);
    place.removeFromTop(6.0f);
    upLabels_ = labelsOf(
        up, place.getHeight(), [](const juce::String&) { return textHeight; }, 6.0f);
    float widest = 18.0f;
    for (const auto& label : upLabels_)
        widest = std::max(widest, widthOf(label.text));
    area_ = place.withTrimmedLeft(widest + 7.0f).withTrimmedRight(10.0f);
    if (plot.x.names.empty()) {
        acrossLabels_ = labelsOf(
            across, area_.getWidth(), [](const juce::String& text) { return widthOf(text); }, labelGap);
    } else {
        for (std::size_t k = 0; k < plot.x.names.size(); ++k)
            acrossLabels_.push_back({static_cast<double>(k), words(plot.x.names[k])});
    }
}

/// The title of the axis that goes up, and the key beside and below it.
void PlotPicture::layOutKey(juce::Rectangle<float>& place)
{
    auto row = place.removeFromTop(line);
    upTitle_ = row.removeFromLeft(std::min(row.getWidth(), widthOf(titleOf(plot_.y)) + 14.0f));
    if (!plot_.key)
        return;
    for (const auto& series : plot_.series) {
        if (series.title.empty())
            continue;
        const auto text = words(series.title);
        const float width = widthOf(text) + swatch + 18.0f;
        if (row.getWidth() < width && row.getWidth() < place.getWidth())
            row = place.removeFromTop(line);
        key_.push_back({&series, text, row.removeFromLeft(std::min(width, row.getWidth()))});
    }
}

juce::Point<float> PlotPicture::at(double x, double y) const
{
    return {area_.getX() + static_cast<float>(std::clamp(across_.share(x), -4.0, 5.0)) * area_.getWidth(),
            area_.getBottom() - static_cast<float>(std::clamp(up_.share(y), -4.0, 5.0)) * area_.getHeight()};
}

bool PlotPicture::drawable(const Series& series, std::size_t k) const
{
    return std::isfinite(series.x[k]) && std::isfinite(series.y[k]) && (!across_.logarithmic || series.x[k] > 0.0)
           && (!up_.logarithmic || series.y[k] > 0.0);
}

void PlotPicture::drawAxes(juce::Graphics& g) const
{
    const auto& colours = look::palette();
    g.setFont(textHeight);
    for (const auto& label : acrossLabels_) {
        const float x = at(label.value, up_.least).x;
        g.setColour(colours.grid);
        g.drawVerticalLine(juce::roundToInt(x), area_.getY(), area_.getBottom());
        const float width = widthOf(label.text) + 2.0f;
        const float left = juce::jlimit(
            area_.getX() - 12.0f, std::max(area_.getX() - 12.0f, area_.getRight() + 14.0f - width), x - 0.5f * width);
        g.setColour(colours.dim);
        g.drawText(label.text, juce::Rectangle<float>(left, area_.getBottom() + 2.0f, width, line - 1.0f),
                   juce::Justification::centred, false);
    }
    for (const auto& label : upLabels_) {
        const float y = at(across_.least, label.value).y;
        g.setColour(colours.grid);
        g.drawHorizontalLine(juce::roundToInt(y), area_.getX(), area_.getRight());
        g.setColour(colours.dim);
        const float width = widthOf(label.text) + 2.0f;
        g.drawText(label.text, juce::Rectangle<float>(area_.getX() - 5.0f - width, y - 7.0f, width, 14.0f),
                   juce::Justification::centredRight, false);
    }
    g.setColour(colours.outline);
    g.drawHorizontalLine(juce::roundToInt(area_.getBottom()), area_.getX(), area_.getRight());
    g.drawVerticalLine(juce::roundToInt(area_.getX()), area_.getY(), area_.getBottom());
}

void PlotPicture::drawBand(juce::Graphics& g, const Series& series) const
{
    const auto count = std::min(series.x.size(), series.y.size());
    if (series.lower.size() != count || series.upper.size() != count || count < 2)
        return;
    // A quadrilateral from point to point: the rasterizer leaves holes in one polygon round the whole band.
    juce::Path band;
    std::size_t before = count;
    for (std::size_t k = 0; k < count; ++k) {
        if (!drawable(series, k) || !std::isfinite(series.lower[k]) || !std::isfinite(series.upper[k]))
            continue;
        if (before < k) {
            const auto a = at(series.x[before], series.lower[before]), b = at(series.x[before], series.upper[before]),
                       c = at(series.x[k], series.upper[k]), d = at(series.x[k], series.lower[k]);
            band.addQuadrilateral(a.x, a.y, b.x, b.y, c.x, c.y, d.x, d.y);
        }
        before = k;
    }
    g.setColour(look::colourOf(series.role).withAlpha(0.18f));
    g.fillPath(band);
}

void PlotPicture::drawLine(juce::Graphics& g, const Series& series) const
{
    juce::Path path;
    bool down = false;
    g.setColour(look::colourOf(series.role));
    for (std::size_t k = 0; k < std::min(series.x.size(), series.y.size()); ++k) {
        if (!drawable(series, k)) {
            down = false;
            continue;
        }
        const auto point = at(series.x[k], series.y[k]);
        down ? path.lineTo(point) : path.startNewSubPath(point);
        down = true;
        if (series.shape == Series::Shape::pointsAndLine)
            g.fillEllipse(juce::Rectangle<float>(7.0f, 7.0f).withCentre(point));
    }
    strokeDashed(g, path, series);
}

void PlotPicture::paint(juce::Graphics& g) const
{
    const auto& colours = look::palette();
    g.setColour(colours.text);
    g.setFont(look::heightThatFits(words(plot_.title), titleHeight, title_.getWidth(), 0.0f, false));
    g.drawText(words(plot_.title), title_, juce::Justification::centredLeft);
    g.setFont(textHeight);
    g.setColour(colours.dim);
    g.drawText(titleOf(plot_.y), upTitle_, juce::Justification::centredLeft);
    g.drawText(titleOf(plot_.x), acrossTitle_.withLeft(area_.getX()), juce::Justification::centred);
    for (const auto& entry : key_) {
        auto place = entry.place;
        const auto mark = place.removeFromLeft(swatch);
        juce::Path path;
        path.startNewSubPath(mark.getX(), mark.getCentreY());
        path.lineTo(mark.getRight(), mark.getCentreY());
        g.setColour(look::colourOf(entry.series->role));
        strokeDashed(g, path, *entry.series);
        g.setColour(colours.dim);
        g.drawText(entry.text, place.withTrimmedLeft(5.0f), juce::Justification::centredLeft);
    }
    drawAxes(g);
    const juce::Graphics::ScopedSaveState inside(g);
    g.reduceClipRegion(area_.getSmallestIntegerContainer().expanded(2));
    for (const auto& series : plot_.series)
        drawBand(g, series);
    for (const auto& series : plot_.series)
        drawLine(g, series);
}

}  // namespace excursion::plugin
