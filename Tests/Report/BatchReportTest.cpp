// SPDX-License-Identifier: GPL-3.0-or-later
#include "Batch/BatchOf.h"
#include "Engine/Error.h"
#include "Report/BatchReport.h"
#include "Report/Gnuplot.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <regex>

using namespace excursion;
using namespace excursion::test;

TEST_CASE("The page of a batch needs nothing else and shows who stands out", "[report]")
{
    try {
        runGnuplot("");
    } catch (const Error&) {
        WARN("gnuplot is not installed; this test is skipped");
        return;
    }
    Units units;
    for (int k = 0; k < 8; ++k)
        units.units.push_back(unitOf("unit <" + std::to_string(k + 1) + ">",
                                     midbassOf(k == 5 ? 1.05 : 1.0 + 1e-3 * ((3 * k) % 8)),
                                     k == 6 ? Verdict::badMeasurement : Verdict::complete));
    units.unread.push_back({"lost", "the folder has no ladder.json"});
    CollectOptions options;
    options.limits = {{"fs", {50.0, 57.0}}, {"Qts", {{}, 0.5}}};
    const auto all = collect(units, options);
    const auto html = batchHtml(all);
    CHECK(html == batchHtml(all));
    for (const auto* outside : {"<link", "src=", "url(", "href=\"http", "@import"})
        CHECK(html.find(outside) == std::string::npos);
    CHECK(html.find("rgb(") == std::string::npos);
    CHECK_FALSE(std::regex_search(html, std::regex("\\bnan\\b")));
    CHECK(html.find("unit &lt;6&gt;") != std::string::npos);
    CHECK(html.find("What stands out") != std::string::npos);
    CHECK(html.find("the folder has no ladder.json") != std::string::npos);
    CHECK(html.find("measured units are within all limits") != std::string::npos);
    // One unit alone has a page, too.
    Units one;
    one.units.push_back(unitOf("a", midbassOf(1.0)));
    CHECK_THAT(batchHtml(collect(one, {})), Catch::Contains("1 of 1 unit is measured"));
    one.units.front() = unitOf("a", {}, Verdict::badMeasurement);
    CHECK_THAT(batchHtml(collect(one, {})), Catch::Contains("0 of 1"));
    if (const char* keep = std::getenv("EXCURSION_KEEP_REPORT"))
        writeBatchReport(all, std::string(keep) + ".batch.html");
}
