// SPDX-License-Identifier: GPL-3.0-or-later
// Documents and their pages, for `browser` beside this file, which looks at them in Chromium.
#include "Batch/BatchOf.h"
#include "Diagnosis/SyntheticLadder.h"
#include "Engine/Document/DraftFile.h"
#include "Report/BatchReport.h"
#include "Report/ModelReport.h"
#include "Report/Report.h"
#include "Report/SampleDocuments.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstdlib>
#include <filesystem>

using namespace excursion;
using namespace excursion::test;

namespace {

/// Curves of two channels at two levels. A gap where nothing rises above the noise.
nlohmann::json wideHarmonics()
{
    nlohmann::json document {{"format", "excursion-harmonics"}, {"version", 1}, {"remarks", nlohmann::json::array()}};
    for (const auto* channel : {"current", "pressure"})
        for (const double level : {0.5, 2.0}) {
            nlohmann::json frequency, one, second, third, floor, thd;
            for (double f = 20.0; f < 10000.0; f *= 1.06) {
                const double h2 = -40.0 + 20.0 * std::log10(level) - 8.0 * std::log10(f / 20.0),
                             h3 = -46.0 + 40.0 * std::log10(level) - 20.0 * std::log10(f / 20.0);
                frequency.push_back(f);
                one.push_back(1.0);
                second.push_back(h2);
                third.push_back(h3 < -85.0 ? nlohmann::json(nullptr) : nlohmann::json(h3));
                floor.push_back(-88.0);
                thd.push_back(10.0 * std::log10(std::pow(10.0, h2 / 10.0) + std::pow(10.0, h3 / 10.0)));
            }
            document["curves"].push_back({{"channel", channel},
                                          {"unit", "1"},
                                          {"level", level},
                                          {"frequency", frequency},
                                          {"fundamental", one},
                                          {"harmonics",
                                           {{{"order", 2}, {"db", second}, {"floorDb", floor}},
                                            {{"order", 3}, {"db", third}, {"floorDb", floor}}}},
                                          {"thd", {{"db", thd}, {"floorDb", floor}}}});
        }
    return document;
}

}  // namespace

TEST_CASE("Documents and pages into the folder that EXCURSION_PAGES names", "[.pages]")
{
    const char* named = std::getenv("EXCURSION_PAGES");
    REQUIRE(named != nullptr);
    const std::filesystem::path folder = named;
    const auto ladder = syntheticLadder();
    writeLadder(ladder, folder / "ladder.json");
    writeReport(ladder, folder / "ladder.html");
    auto documents = sampleDocuments();
    documents.harmonics = wideHarmonics();
    for (const auto& document : documents.all()) {
        const auto name = document.at("format").get<std::string>();
        publish(folder / (name + ".json"), document.dump());
        writeDocumentPage(JsonField(document, "", name), folder / (name + ".html"));
    }
    Units units;
    for (int k = 0; k < 20; ++k)
        units.units.push_back(unitOf("unit " + std::to_string(k + 1),
                                     midbassOf(k == 5 ? 1.05 : 1.0 + 1e-3 * ((3 * k) % 8)),
                                     k == 6 ? Verdict::badMeasurement : Verdict::complete));
    CollectOptions options;
    options.limits = {{"fs", {50.0, 57.0}}, {"Qts", {{}, 0.5}}};
    writeBatchReport(collect(units, options), folder / "batch.html");
}
