// SPDX-License-Identifier: GPL-3.0-or-later
// Plots in the window: their axes, and what a person reads, zooms and saves.
#include "BlackBox/EveryClass.h"
#include "Engine/Error.h"
#include "Plugin/Walk.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>

using namespace excursion;
using plugin::Editor;
using plugin::PageName;
using plugin::Processor;
using plugin::words;

TEST_CASE("Axes of any range have at least three labels, which ascend and tell each other apart", "[plugin]")
{
    juce::Random random(7);
    const auto width = [](const juce::String& text) { return 6.5f * static_cast<float>(text.length()); };
    for (int k = 0; k < 4000; ++k) {
        const bool logarithmic = random.nextBool();
        const double size = std::pow(10.0, 24.0 * random.nextDouble() - 12.0);
        plugin::AxisRange range;
        if (logarithmic)
            range = {size, size * std::pow(10.0, 0.02 + 5.0 * random.nextDouble()), true};
        else {
            const double middle = size * (2.0 * random.nextDouble() - 1.0);
            range = {middle - size * (1e-3 + random.nextDouble()), middle + size * (1e-3 + random.nextDouble()), false};
        }
        const float length = 60.0f + 900.0f * random.nextFloat();
        const auto labels = plugin::labelsOf(range, length, width, 6.0f);
        INFO(range.least << " .. " << range.most << (logarithmic ? " log" : "") << ", " << length << " px");
        REQUIRE(labels.size() >= 3);
        for (std::size_t n = 0; n < labels.size(); ++n) {
            REQUIRE(range.share(labels[n].value) > -1e-6);
            REQUIRE(range.share(labels[n].value) < 1.0 + 1e-6);
            if (n > 0) {
                REQUIRE(labels[n].value > labels[n - 1].value);
                REQUIRE(labels[n].text != labels[n - 1].text);
            }
        }
        if (length > 400.0f && labels.size() > 3)
            for (std::size_t n = 1; n < labels.size(); ++n)
                REQUIRE((range.share(labels[n].value) - range.share(labels[n - 1].value)) * length
                        >= 0.5 * (width(labels[n].text) + width(labels[n - 1].text)));
    }
    const plugin::AxisRange band {20.0, 20000.0, true};
    const auto labels = plugin::labelsOf(band, 600.0f, width, 8.0f);
    REQUIRE(labels.size() == 10);
    CHECK(labels.front().text == "20");
    CHECK(labels.back().text == "20k");
}

TEST_CASE("A plot is read, zoomed and saved", "[plugin]")
{
    plugin::PlotView view;
    view.setSize(400, 260);
    Plot plot;
    plot.title = "Law, of \"x\"";
    plot.x = {"displacement", "mm", false, 0.0, 0.0, {}};
    plot.y = {"force", "N", false, 0.0, 0.0, {}};
    Series series {"measured", Role::measured, {}, {}, {}, {}, Series::Shape::line, 0};
    for (int k = -100; k <= 100; ++k) {
        series.x.push_back(0.05 * k);
        series.y.push_back(0.25 * k * k / 400.0);
        series.lower.push_back(series.y.back() - 1.0);
        series.upper.push_back(series.y.back() + 1.0);
    }
    plot.series = {series};
    view.show(plot);
    CHECK(view.reading().isEmpty());
    view.putCursor(2.0);
    REQUIRE(view.reading().size() == 2);
    CHECK(view.reading()[0].getDoubleValue() == Approx(2.0));
    CHECK(view.reading()[0].endsWith("mm"));
    CHECK(view.reading()[1].fromFirstOccurrenceOf("measured  ", false, false).getDoubleValue() == Approx(1.0));
    CHECK(view.keyPressed(juce::KeyPress(juce::KeyPress::rightKey)));
    CHECK(view.reading()[0].getDoubleValue() == Approx(2.1).margin(0.02));

    const auto whole = view.range(true);
    CHECK_FALSE(view.zoomed());
    CHECK(view.keyPressed(juce::KeyPress('+', {}, '+')));
    CHECK(view.zoomed());
    CHECK(view.range(true).most - view.range(true).least == Approx(0.8 * (whole.most - whole.least)));
    const auto zoomed = view.range(true);
    view.show(plot);  // the same picture anew: the zoom stays
    CHECK(view.range(true) == zoomed);
    CHECK(view.keyPressed(juce::KeyPress(juce::KeyPress::homeKey)));
    CHECK(view.range(true) == whole);
    for (int k = 0; k < 200; ++k)
        view.keyPressed(juce::KeyPress('+', {}, '+'));
    CHECK(view.range(true).most > view.range(true).least);
    CHECK(view.labels(true).size() >= 3);
    for (int k = 0; k < 200; ++k)
        view.keyPressed(juce::KeyPress('-', {}, '-'));
    CHECK(view.range(true).least == Approx(whole.least));
    CHECK(view.range(true).most == Approx(whole.most));

    const auto folder = juce::File::createTempFile("plots");
    REQUIRE(folder.createDirectory().wasOk());
    view.save(folder.getChildFile("a.csv"));
    const auto lines = juce::StringArray::fromLines(folder.getChildFile("a.csv").loadFileAsString().trimEnd());
    REQUIRE(lines.size() == 202);
    CHECK(lines[0] == "series,displacement (mm),force (N),lower,upper");
    CHECK(lines[1] == "measured,-5,6.25,5.25,7.25");
    view.save(folder.getChildFile("a.png"));
    const auto image = juce::ImageFileFormat::loadFrom(folder.getChildFile("a.png"));
    CHECK(image.getWidth() >= 800);
    // What the dialog has not asked about is not written over; what it has is.
    juce::String said;
    bool trouble = false;
    view.told = [&](const juce::String& text, bool bad) {
        said = text;
        trouble = bad;
    };
    REQUIRE(folder.getChildFile("fig.csv").replaceWithText("mine"));
    view.saveAs(folder.getChildFile("fig"), "csv");
    CHECK(trouble);
    CHECK(said.contains("fig.csv"));
    CHECK(folder.getChildFile("fig.csv").loadFileAsString() == "mine");
    view.saveAs(folder.getChildFile("fig.csv"), "csv");
    CHECK_FALSE(trouble);
    CHECK(folder.getChildFile("fig.csv").loadFileAsString().startsWith("series,"));
    view.saveAs(folder.getChildFile("other"), "csv");
    CHECK_FALSE(trouble);
    CHECK(folder.getChildFile("other.csv").existsAsFile());
    CHECK_THROWS_AS(view.save(folder.getChildFile("a.doc")), Error);
    CHECK_THROWS_AS(view.save(folder.getChildFile("none").getChildFile("a.csv").getChildFile("b.csv")), Error);
    try {
        view.save(folder.getChildFile("a.svg"));
        const auto svg = juce::parseXML(folder.getChildFile("a.svg"));
        REQUIRE(svg != nullptr);
        CHECK(svg->hasTagName("svg"));
        CHECK(svg->toString().contains("Law, of "));
        CHECK_FALSE(svg->toString().contains("var("));
    } catch (const Error& error) {
        WARN("SKIPPED: " << error.what());
    }
    folder.deleteRecursively();
}
