// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/PlotView.h"

#include "Engine/Error.h"
#include "Plots/PlotCsv.h"
#include "Plugin/Look.h"
#include "Plugin/Text.h"
#include "Report/Draw.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace excursion::plugin {
namespace {

constexpr float menuWidth = 26.0f;
constexpr float shortestFrame = 6.0f;  // px; what is shorter was a click
constexpr int pictureScale = 2;        // of a PNG, as its pixels are to be printed

/// Digits by which a thousandth of the range is told.
juce::String readingText(double value, const AxisRange& range)
{
    const double span = range.logarithmic ? std::abs(value) : range.most - range.least;
    return numberText(value, std::pow(10.0, std::floor(std::log10(std::max(1e-300, 1e-3 * span)))));
}

juce::String withUnit(const juce::String& text, const std::string& unit)
{
    return unit.empty() ? text : text + " " + words(unit);
}

}  // namespace

PlotView::PlotView()
{
    setWantsKeyboardFocus(true);
    setTitle("Plot");
    menu_.setButtonText(words("\u22ef"));
    menu_.setTitle("Save or zoom this plot");
    menu_.setTooltip("Save as PNG, SVG or CSV");
    menu_.setWantsKeyboardFocus(false);  // Return on the plot does the same
    menu_.onClick = [this] { offer(); };
    addChildComponent(menu_);
}

PlotView::~PlotView() = default;

void PlotView::show(Plot plot)
{
    const bool same = plot.title == plot_.title && plot.x.title == plot_.x.title && plot.y.title == plot_.y.title
                      && plot.x.unit == plot_.x.unit && plot.y.unit == plot_.y.unit && zoomed();
    plot_ = std::move(plot);
    wholeAcross_ = rangeOf(plot_, true);
    wholeUp_ = rangeOf(plot_, false);
    if (!same) {
        across_ = wholeAcross_;
        up_ = wholeUp_;
    }
    const bool empty = plot_.series.empty();
    menu_.setVisible(!empty);
    setWantsKeyboardFocus(!empty);
    const auto title = words(plot_.title.empty() ? plot_.y.title + " against " + plot_.x.title : plot_.title);
    setTitle(empty ? juce::String("Empty plot") : title);
    juce::StringArray lines;
    for (const auto& series : plot_.series)
        if (!series.title.empty())
            lines.add(words(series.title));
    setDescription(empty ? juce::String()
                         : "Plot of " + words(plot_.y.title) + " against " + words(plot_.x.title) + ": "
                               + lines.joinIntoString(", ")
                               + ". The arrow keys read it, plus and minus zoom, Return saves it.");
    repaint();
}

Plot PlotView::seen() const
{
    auto plot = plot_;
    plot.x.least = across_.least;
    plot.x.most = across_.most;
    plot.y.least = up_.least;
    plot.y.most = up_.most;
    return plot;
}

PlotPicture PlotView::picture() const
{
    return {plot_, across_, up_, getLocalBounds().toFloat().reduced(2.0f), menuWidth};
}

std::vector<AxisLabel> PlotView::labels(bool across) const { return picture().labels(across); }

void PlotView::zoom(const AxisRange& across, const AxisRange& up)
{
    across_ = across;
    up_ = up;
    repaint();
}

void PlotView::showAll() { zoom(wholeAcross_, wholeUp_); }

juce::Point<double> PlotView::sharesAt(juce::Point<float> where) const
{
    const auto area = picture().area();
    return {(where.x - area.getX()) / static_cast<double>(area.getWidth()),
            (area.getBottom() - where.y) / static_cast<double>(area.getHeight())};
}

void PlotView::zoomAbout(juce::Point<double> shares, double factor, bool across, bool up)
{
    const auto part = [factor](const AxisRange& range, const AxisRange& whole, double share) {
        auto result = range.part(share - share * factor, share + (1.0 - share) * factor);
        result.least = std::max(result.least, whole.least);
        result.most = std::min(result.most, whole.most);
        return result;
    };
    zoom(across ? part(across_, wholeAcross_, shares.x) : across_, up ? part(up_, wholeUp_, shares.y) : up_);
}

void PlotView::putCursor(double x)
{
    cursor_ = x;
    repaint();
}

void PlotView::mouseMove(const juce::MouseEvent& event)
{
    if (picture().area().contains(event.position) && !plot_.series.empty())
        putCursor(across_.value(sharesAt(event.position).x));
    else
        mouseExit(event);
}

void PlotView::mouseExit(const juce::MouseEvent&)
{
    cursor_.reset();
    repaint();
}

void PlotView::mouseDown(const juce::MouseEvent& event)
{
    if (event.mods.isPopupMenu()) {
        offer();
        return;
    }
    from_ = sharesAt(event.position);
    draggedAcross_ = across_;
    draggedUp_ = up_;
    frame_ = {};
}

void PlotView::mouseDrag(const juce::MouseEvent& event)
{
    if (event.mods.isPopupMenu() || plot_.series.empty())
        return;
    if (event.mods.isCtrlDown()) {
        const auto area = picture().area();
        const double dx = event.getOffsetFromDragStart().x / static_cast<double>(area.getWidth()),
                     dy = event.getOffsetFromDragStart().y / static_cast<double>(area.getHeight());
        zoom(draggedAcross_.part(-dx, 1.0 - dx), draggedUp_.part(dy, 1.0 + dy));
        return;
    }
    frame_ = juce::Rectangle<float>(event.mouseDownPosition, event.position).getIntersection(picture().area());
    repaint();
}

void PlotView::mouseUp(const juce::MouseEvent&)
{
    const auto frame = std::exchange(frame_, {});
    if (frame.getWidth() < shortestFrame && frame.getHeight() < shortestFrame)
        return;
    const auto from = sharesAt(frame.getBottomLeft()), to = sharesAt(frame.getTopRight());
    // A frame that is nearly a line stands for one axis.
    zoom(frame.getWidth() >= shortestFrame ? across_.part(from.x, to.x) : across_,
         frame.getHeight() >= shortestFrame ? up_.part(from.y, to.y) : up_);
}

void PlotView::mouseWheelMove(const juce::MouseEvent& event, const juce::MouseWheelDetails& wheel)
{
    if (!picture().area().contains(event.position) || plot_.series.empty()) {
        Component::mouseWheelMove(event, wheel);
        return;
    }
    const bool up = event.mods.isShiftDown();
    // with Shift some systems turn the wheel sideways
    const float turned = wheel.deltaY != 0.0f ? wheel.deltaY : wheel.deltaX;
    zoomAbout(sharesAt(event.position), std::exp(-static_cast<double>(turned)), !up, up);
}

bool PlotView::keyPressed(const juce::KeyPress& key)
{
    if (plot_.series.empty())
        return false;
    const auto move = [this](double by) {
        const double share = cursor_ ? across_.share(*cursor_) + by : 0.5;
        putCursor(across_.value(juce::jlimit(0.0, 1.0, share)));
        return true;
    };
    const auto about = [this] {
        return juce::Point<double>(cursor_ ? juce::jlimit(0.0, 1.0, across_.share(*cursor_)) : 0.5, 0.5);
    };
    if (key == juce::KeyPress::leftKey)
        return move(-0.01);
    if (key == juce::KeyPress::rightKey)
        return move(0.01);
    if (key == juce::KeyPress::returnKey
        || key == juce::KeyPress(juce::KeyPress::F10Key, juce::ModifierKeys::shiftModifier, 0)) {
        offer();
        return true;
    }
    if (key == juce::KeyPress::homeKey) {
        showAll();
        return true;
    }
    if (const auto c = key.getTextCharacter(); c == '+' || c == '-') {
        zoomAbout(about(), c == '+' ? 0.8 : 1.25, true, true);
        return true;
    }
    return false;
}

void PlotView::focusLost(FocusChangeType)
{
    cursor_.reset();
    repaint();
}

std::size_t PlotView::nearest(const Series& series, double x) const
{
    std::size_t best = 0;
    double least = 1e300;
    for (std::size_t k = 0; k < std::min(series.x.size(), series.y.size()); ++k)
        if (const double far = std::abs(across_.share(series.x[k]) - across_.share(x)); far < least) {
            least = far;
            best = k;
        }
    return best;
}

juce::StringArray PlotView::reading() const
{
    if (!cursor_)
        return {};
    const auto at = static_cast<std::size_t>(std::max(0.0, std::round(*cursor_)));
    juce::StringArray lines {plot_.x.names.empty()
                                 ? withUnit(readingText(*cursor_, across_), plot_.x.unit)
                                 : words(plot_.x.title) + " "
                                       + words(plot_.x.names[std::min(at, plot_.x.names.size() - 1)])};
    for (const auto& series : plot_.series) {
        if (series.title.empty() || series.x.empty())
            continue;
        if (const auto k = nearest(series, *cursor_); k < series.y.size() && std::isfinite(series.y[k]))
            lines.add(words(series.title) + "  " + withUnit(readingText(series.y[k], up_), plot_.y.unit));
    }
    return lines;
}

void PlotView::drawReading(juce::Graphics& g, const PlotPicture& picture) const
{
    if (!cursor_ || !frame_.isEmpty())
        return;
    const auto& colours = look::palette();
    const auto area = picture.area();
    const float x = picture.at(*cursor_, up_.least).x;
    g.setColour(colours.dim);
    g.drawVerticalLine(juce::roundToInt(x), area.getY(), area.getBottom());
    for (const auto& series : plot_.series)
        if (!series.title.empty() && !series.x.empty())
            if (const auto k = nearest(series, *cursor_);
                k < series.y.size() && std::isfinite(series.y[k]) && (!up_.logarithmic || series.y[k] > 0.0))
                if (const auto point = picture.at(series.x[k], series.y[k]); area.contains(point)) {
                    g.setColour(look::colourOf(series.role));
                    g.fillEllipse(juce::Rectangle<float>(6.0f, 6.0f).withCentre(point));
                }
    const auto lines = reading();
    g.setFont(12.0f);
    float width = 0.0f;
    for (const auto& line : lines)
        width = std::max(width, g.getCurrentFont().getStringWidthFloat(line) + 14.0f);
    auto box = juce::Rectangle<float>(x + 10.0f, area.getY() + 4.0f, width,
                                      15.0f * static_cast<float>(lines.size()) + 6.0f);
    if (box.getRight() > area.getRight())
        box.setX(std::max(2.0f, x - 10.0f - width));
    box.setY(std::max(2.0f, std::min(box.getY(), static_cast<float>(getHeight()) - 2.0f - box.getHeight())));
    g.setColour(colours.background.withAlpha(0.94f));
    g.fillRoundedRectangle(box, 4.0f);
    g.setColour(colours.outline);
    g.drawRoundedRectangle(box, 4.0f, 1.0f);
    g.setColour(colours.text);
    box.reduce(7.0f, 3.0f);
    for (const auto& line : lines)
        g.drawText(line, box.removeFromTop(15.0f), juce::Justification::centredLeft);
}

void PlotView::paint(juce::Graphics& g)
{
    const auto& colours = look::palette();
    const auto panel = getLocalBounds().toFloat().reduced(2.0f);
    g.setColour(colours.panel);
    g.fillRoundedRectangle(panel, 4.0f);
    if (plot_.series.empty()) {
        g.setColour(colours.dim);
        g.setFont(14.0f);
        g.drawFittedText(getProperties()["empty"].toString(), getLocalBounds().reduced(20),
                         juce::Justification::centred, 3, 1.0f);
        return;
    }
    const auto shown = picture();
    shown.paint(g);
    if (!frame_.isEmpty()) {
        g.setColour(colours.accent.withAlpha(0.18f));
        g.fillRect(frame_);
        g.setColour(colours.accent);
        g.drawRect(frame_, 1.0f);
    }
    drawReading(g, shown);
}

void PlotView::resized() { menu_.setBounds(getWidth() - 34, 6, 26, 18); }

void PlotView::offer()
{
    if (plot_.series.empty())
        return;
    juce::PopupMenu menu;
    menu.setLookAndFeel(&getLookAndFeel());
    const auto save = [this](const char* ending) {
        return [safe = juce::Component::SafePointer<PlotView>(this), ending] {
            if (safe != nullptr)
                safe->choose(ending);
        };
    };
    menu.addItem("Save the picture as PNG...", save("png"));
    menu.addItem("Save the picture as SVG...", save("svg"));
    menu.addItem("Save the numbers as CSV...", save("csv"));
    menu.addSeparator();
    menu.addItem("Show all (double click)", zoomed(), false, [safe = juce::Component::SafePointer<PlotView>(this)] {
        if (safe != nullptr)
            safe->showAll();
    });
    menu.showMenuAsync(juce::PopupMenu::Options().withTargetComponent(menu_));
}

void PlotView::choose(const juce::String& ending)
{
    const auto first = juce::File::getSpecialLocation(juce::File::userHomeDirectory)
                           .getChildFile(
                               juce::File::createLegalFileName(getTitle().toLowerCase().replaceCharacter(' ', '-'))
                               + "." + ending);
    chooser_ = std::make_unique<juce::FileChooser>("Save the plot", first, "*." + ending);
    chooser_->launchAsync(juce::FileBrowserComponent::saveMode | juce::FileBrowserComponent::warnAboutOverwriting,
                          [this, ending](const juce::FileChooser& chosen) {
                              if (chosen.getResult() != juce::File())
                                  saveAs(chosen.getResult(), ending);
                          });
}

void PlotView::saveAs(const juce::File& chosen, const juce::String& ending) const
{
    const auto file = chosen.withFileExtension(ending);
    const auto tell = [this](const juce::String& text, bool trouble) {
        if (told)
            told(text, trouble);
    };
    // The dialog has asked about the name that was chosen, not about the one with the ending.
    if (file != chosen && file.exists()) {
        tell("\"" + file.getFileName() + "\" is there already: choose another name, or this one with its ending.",
             true);
        return;
    }
    try {
        save(file);
        tell("Wrote " + file.getFullPathName() + ".", false);
    } catch (const Error& error) {
        tell(words(error.what()), true);
    }
}

void PlotView::save(const juce::File& file) const
{
    juce::MemoryOutputStream bytes;
    if (file.hasFileExtension("png")) {
        const auto plot = seen();
        const int width = std::max(getWidth(), plot.width), height = std::max(getHeight(), plot.height);
        juce::Image image(juce::Image::RGB, pictureScale * width, pictureScale * height, true);
        juce::Graphics g(image);
        g.addTransform(juce::AffineTransform::scale(static_cast<float>(pictureScale)));
        g.fillAll(look::palette().panel);
        PlotPicture(plot, across_, up_, juce::Rectangle<int>(width, height).toFloat().reduced(4.0f), 0.0f).paint(g);
        juce::PNGImageFormat().writeImageToStream(image, bytes);
    } else if (file.hasFileExtension("svg")) {
        bytes << words(svgDocument(seen()));
    } else if (file.hasFileExtension("csv")) {
        bytes << words(plotCsv(plot_));
    } else {
        throw Error(Error::Kind::usage, "A plot is saved as .png, .svg or .csv, not as '"
                                            + file.getFileName().toStdString() + "': give it one of these endings.");
    }
    if (!file.replaceWithData(bytes.getData(), bytes.getDataSize()))
        throw Error(Error::Kind::input,
                    "'" + file.getFullPathName().toStdString() + "' cannot be written: choose another folder.");
}

std::unique_ptr<juce::AccessibilityHandler> PlotView::createAccessibilityHandler()
{
    return std::make_unique<juce::AccessibilityHandler>(*this, juce::AccessibilityRole::image);
}

}  // namespace excursion::plugin
