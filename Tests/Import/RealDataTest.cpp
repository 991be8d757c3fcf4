// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/ImportMat.h"
#include "Engine/Import/ImportText.h"
#include "Engine/Import/ReadTake.h"
#include "Scratch.h"
#include "SilverboxColumns.h"
#include "SomeMultisine.h"

#include <cmath>

using namespace excursion;
using namespace excursion::test;

TEST_CASE("The Silverbox is read from MAT and CSV alike")
{
    const auto folder = dataFolder("silverbox");
    if (folder.empty())
        return;
    const auto mat = importMat(folder / "SNLS80mV.mat", silverboxColumns());
    const auto csv = std::get<Measurement>(importText(folder / "SNLS80mV.csv", silverboxColumns()));
    REQUIRE(mat.length() == 131072);
    REQUIRE(csv.length() == 131072);
    CHECK(mat.input().quantity == Quantity::force);
    CHECK(rms(mat.channels[0].samples) == Approx(21.92e-3).epsilon(0.001));
    CHECK(rms(mat.channels[1].samples) == Approx(53.37e-3).epsilon(0.001));
    double worst = 0;
    for (std::size_t n = 0; n < mat.length(); ++n)
        worst = std::max(worst, std::abs(mat.channels[1].samples[n] - csv.channels[1].samples[n]));
    CHECK(worst < 1e-5);  // the CSV has five digits

    const auto schroeder = std::get<Measurement>(importText(folder / "Schroeder80mV.csv", silverboxColumns()));
    CHECK(schroeder.length() == 131072);

    const auto bytes = bytesOf(folder / "SNLS80mV.mat");
    const Scratch s;
    const auto truncated = s.file("t.mat", std::string_view(bytes).substr(0, bytes.size() / 3));
    CHECK_THROWS_AS(importMat(truncated, silverboxColumns()), Error);
    auto o = silverboxColumns();
    o.columns[0].column = "V9";
    refused(Error::Kind::usage, "V2", [&] { importMat(folder / "SNLS80mV.mat", o); });
    o = silverboxColumns();
    o.sampleRate = 0;
    refused(Error::Kind::usage, "--rate", [&] { importMat(folder / "SNLS80mV.mat", o); });
}

TEST_CASE("Novak's spectra are read as a take")
{
    const auto folder = dataFolder("novak");
    if (folder.empty())
        return;
    const auto take = std::get<Spectra>(readTake(folder / "novak.csv"));
    REQUIRE(take.frequency.size() == 21996);
    const auto &u = take.find(Quantity::voltage)->values, &i = take.find(Quantity::current)->values;
    REQUIRE(take.find(Quantity::velocity));
    CHECK(std::abs(u[15] / i[15]) == Approx(5.55).epsilon(0.005));    // 20 Hz
    CHECK(std::abs(u[158] / i[158]) == Approx(53.0).epsilon(0.005));  // 163 Hz
}

TEST_CASE("Every impedance file at hand is read")
{
    const auto folder = GENERATE(as<std::string> {}, "impedance", "seas-l16rnx");
    const auto path = dataFolder(folder);
    if (path.empty())
        return;
    for (const auto& entry : std::filesystem::directory_iterator(path))
        if (entry.path().extension() == ".zma") {
            INFO(entry.path());
            const auto take = std::get<Spectra>(readTake(entry.path()));
            CHECK(take.frequency.size() > 200);
            CHECK(take.frequency.back() > 19000);
            CHECK(std::abs(take.find(Quantity::voltage)->values.front()) > 1.0);
        }
}
