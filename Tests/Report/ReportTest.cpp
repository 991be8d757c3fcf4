// SPDX-License-Identifier: GPL-3.0-or-later
#include "Diagnosis/SyntheticLadder.h"

#include "Engine/Document/Engineering.h"
#include "Engine/Document/TextFile.h"
#include "Engine/Error.h"
#include "Plots/Words.h"
#include "Report/CurveData.h"
#include "Report/Draw.h"
#include "Report/Gnuplot.h"
#include "Report/Report.h"
#include "Report/Chapters.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cstdlib>
#include <regex>

using namespace excursion;

namespace {

bool hasGnuplot()
{
    try {
        runGnuplot("");
        return true;
    } catch (const Error&) {
        WARN("gnuplot is not installed; this test is skipped");
        return false;
    }
}

std::size_t count(const std::string& text, const std::string& what)
{
    std::size_t n = 0;
    for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size()))
        ++n;
    return n;
}

}  // namespace

TEST_CASE("The report is one page that needs nothing else", "[report]")
{
    if (!hasGnuplot())
        return;
    const auto file = test::syntheticLadder();
    const auto html = reportHtml(file);
    CHECK(html == reportHtml(file));
    CHECK(count(html, "<svg") > 20);
    CHECK(count(html, "<svg") == count(html, "</svg>"));
    for (const auto* outside : {"<link", "src=", "url(", "href=\"http", "@import"})
        CHECK(html.find(outside) == std::string::npos);
    CHECK(html.find("&lt;script&gt;alert(1)") != std::string::npos);
    CHECK(count(html, "<script") == 2);  // the curves and what shows them, within the page
    CHECK(count(html, "</script") == 2);
    CHECK(html.find("rgb(") == std::string::npos);                  // every colour is the page's
    CHECK_FALSE(std::regex_search(html, std::regex("\\bnan\\b")));  // a word: resonances are no numbers
    for (const auto& rung : file.ladder.rungs)
        if (!rung.added.empty())
            CHECK(html.find(escapeHtml(effectTitle(rung.added))) != std::string::npos);
    if (const char* keep = std::getenv("EXCURSION_KEEP_REPORT"))
        writeReport(file, keep);
}

TEST_CASE("A ladder without a rung still makes a report of what is wrong with the take", "[report]")
{
    auto file = test::syntheticLadder();
    file.ladder.rungs.clear();
    file.responses.clear();
    file.ladder.verdict = Verdict::badMeasurement;
    file.ladder.sentence = "The take cannot be used: the current channel is dead.";
    const auto html = reportHtml(file);
    CHECK(html.find(file.ladder.sentence) != std::string::npos);
    CHECK(html.find(file.ladder.problems.front().kind) != std::string::npos);
}

TEST_CASE("Empty and unusual data is drawn without complaint", "[report]")
{
    if (!hasGnuplot())
        return;
    Plot empty;
    empty.title = "nothing";
    Plot odd;
    odd.x = {"it's 'quoted'\n\\ {x}_2 `date`", "Hz", true, 0.0, 0.0, {}};
    odd.y = {"y", "", true, 0.0, 0.0, {}};
    const double nan = std::numeric_limits<double>::quiet_NaN();
    odd.series = {
        {"'", Role::measured, {0.0, 1.0, 2.0, nan, 4.0}, {1.0, -1.0, 3.0, 4.0, 5.0}, {}, {}, Series::Shape::line, 0},
        {"void", Role::error, {nan}, {nan}, {}, {}, Series::Shape::line, 0}};
    const auto pictures = draw({empty, odd});
    REQUIRE(pictures.size() == 2);
    CHECK(pictures[1].find("`date`") != std::string::npos);
}

TEST_CASE("The script is given every curve once, with gaps, and nothing that ends it", "[report]")
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    Plot plot;
    plot.title = "</script><b>";
    plot.x = {"f", "Hz", true, 0.0, 0.0, {}};
    plot.y = {"y", "", false, -1.0, 1.0, {}};
    plot.series = {{"a", Role::measured, {10.0, 20.0, 30.0}, {0.123456789, nan, 2.0}, {}, {}, Series::Shape::line, 0},
                   {"b", Role::noise, {10.0, 20.0, 30.0}, {1.0}, {0.5}, {1.5}, Series::Shape::pointsAndLine, 4}};
    const auto text = curveData({plot, plot});
    CHECK(text.find('<') == std::string::npos);
    const auto document = nlohmann::json::parse(text);
    REQUIRE(document.at("plots").size() == 2);
    const auto& drawn = document.at("plots")[1];
    CHECK(drawn.at("title") == "</script><b>");
    CHECK(drawn.at("y").at("most") == 1.0);
    const auto& arrays = document.at("arrays");
    const auto& [a, b] = std::pair(drawn.at("series")[0], drawn.at("series")[1]);
    CHECK(arrays[a.at("x").get<std::size_t>()] == nlohmann::json {10, 20, 30});
    CHECK(arrays[a.at("y").get<std::size_t>()] == nlohmann::json {0.123457, nullptr, 2});
    CHECK(arrays[b.at("upper").get<std::size_t>()] == nlohmann::json {1.5});
    CHECK(b.at("colour") == "--noise");
    CHECK(b.at("points") == true);
    CHECK(arrays.size() == 6);  // of both pictures together
}

TEST_CASE("Numbers are written as an engineer does", "[report]")
{
    CHECK(engineering(0.01435, "kg") == "14.35\u202fg");
    CHECK(engineering(2.66e-4, "H", 3) == "266\u202f\u00b5H");
    CHECK(engineering(0.0132, "m^2", 3) == "132\u202fcm\u00b2");
    CHECK(engineering(1852.0, "N/m") == "1852\u202fN/m");
    CHECK(engineering(-3.3, "ohm", 2)
          == "\u2212"
             "3.3\u202f\u03a9");
    CHECK(engineering(0.74, "1", 2) == "0.74");
    CHECK(engineering(std::numeric_limits<double>::quiet_NaN(), "V") == "unknown");
    CHECK(engineering(0.9999, "m", 2) == "1.0\u202fm");
    CHECK(engineering(0.15, "kg", 3) == "150\u202fg");
    CHECK(nominal(48000.0, "Hz") == "48\u202fkHz");
    CHECK(nominal(1.7, "V") == "1.7\u202fV");
    CHECK(nominal(100.0, "V") == "100\u202fV");
    CHECK(withError(0.01435, 3.1e-5, "kg") == "14.350 \u00b1 0.031\u202fg");
    CHECK(withError(0.01435, std::numeric_limits<double>::quiet_NaN(), "kg") == "14.35\u202fg");
    CHECK(decibels(-61.04)
          == "\u2212"
             "61.0\u202fdB");
    CHECK(fixedText(-0.01, 1) == "0.0");
}
