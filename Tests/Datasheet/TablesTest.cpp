// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Datasheet/DatasheetFile.h"
#include "Engine/Datasheet/ResponseCurves.h"
#include "Engine/Datasheet/SpiceNetlist.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/SmallSignal.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace excursion;

namespace {

Model bent()
{
    auto model = makeModel("electrodynamic");
    model.name = "caf\u00e9\n.END";
    model.path.parameters[0].value = 0.0133;
    for (const auto* id : {"stiffness", "force-factor", "inductance-current"}) {
        model = withEffect(std::move(model), effectNamed(id),
                           OperatingRange {.displacement = 3e-3,
                                           .velocity = 0.5,
                                           .current = 2.0,
                                           .lowFrequency = 20.0,
                                           .highFrequency = 5000.0,
                                           .degree = 2});
        auto& p = model.components.back().parameters;
        p[1].value = std::string(id) == "stiffness" ? 400.0 : std::string(id) == "force-factor" ? -0.5 : -2e-5;
    }
    model.covariance = Eigen::MatrixXd::Zero(parameterVector(model).size(), parameterVector(model).size());
    for (Eigen::Index k = 0; k < model.covariance.rows(); ++k)
        model.covariance(k, k) = std::pow(1e-3 * parameterVector(model)[k], 2);
    return model;
}

const LawTable& named(const std::vector<LawTable>& laws, const std::string& name)
{
    for (const auto& law : laws)
        if (law.name == name)
            return law;
    throw std::out_of_range(name);
}

}  // namespace

TEST_CASE("Laws are told over the range with their bands, and the compliance as the reciprocal", "[datasheet]")
{
    const ScaledModel given {bent(), false, false};
    const auto tables = lawTables(given, 11);
    REQUIRE(tables.size() == 4);
    const auto &K = named(tables, "K(x)"), &C = named(tables, "Cms(x)"), &Bl = named(tables, "Bl(x)");
    CHECK(K.at.front() == -3e-3);
    CHECK(K.at.back() == 3e-3);
    CHECK(K.at[5] == 0.0);
    CHECK(K.value[5] == 2000.0);
    CHECK(K.value.back() == Approx(2000.0 + 2.0 * 400.0));  // K + 2 c2 (x/X)^2
    CHECK(K.high95[5] - K.low95[5] == Approx(2.0 * 1.96 * 2.0).epsilon(1e-6));
    CHECK(C.value.back() == Approx(1.0 / 2800.0));
    CHECK(C.low95[5] == Approx(1.0 / K.high95[5]));
    CHECK(C.low95[5] < C.high95[5]);
    CHECK(Bl.value.front() == Approx(5.0 - 1.0));
    CHECK(named(tables, "Le(i)").at.back() == 2.0);
    // Of a motion that is a guess there is no x.
    const auto guessed = lawTables({bent(), true, false}, 11);
    REQUIRE(guessed.size() == 1);
    CHECK(guessed.front().name == "Le(i)");
}

TEST_CASE("A datasheet as CSV and JSON", "[datasheet]")
{
    const auto sheet = datasheetOf({bent(), false, false}, 0.0, 0.0, 5);
    const auto csv = parametersCsv(sheet), lawText = lawsCsv(sheet);
    CHECK_THAT(csv, Catch::StartsWith("symbol,value,standard_error,unit,remark\nRe,6,0.006")
                        && Catch::Contains("\nMms,10,0.01,g,") && Catch::Contains("\nSd,133,"));
    CHECK(csv.find(",nan") == std::string::npos);
    CHECK_THAT(lawText, Catch::Contains("K(x),x,m,0,2000,")
                            && Catch::Contains("limit,force factor Bl(x) falls to 82 %,m,-0.00"));
    const auto document = toJson(sheet);
    CHECK(document.at("thieleSmall")[3].at("symbol") == "Mms");
    CHECK(document.at("thieleSmall")[3].at("value").get<double>() == Approx(0.01));
    CHECK(document.at("thieleSmall")[3].at("sheetValue").get<double>() == Approx(10.0));
    CHECK(document.at("inductance").at("lossless") == true);
    CHECK(document.at("stroke").at("limits").size() >= 3);
    CHECK(toJson(datasheetOf(withKnown(makeModel("mechanical"), {}))).at("inductance").is_null());
}

TEST_CASE("Curves of small signals", "[datasheet]")
{
    auto model = bent();
    model.path.parameters[1].value = 1e-3;
    model.microphoneDistance = 0.25;
    const ScaledModel given {model, false, false};
    const auto frequency = curveFrequencies(20.0, 20.0 * 1024.0);
    CHECK(frequency.size() == 481);
    CHECK(frequency[48] == Approx(40.0).epsilon(1e-12));
    const auto Z = impedanceCurve(model, {1e-3}), sound = soundCurve(given, {20000.0});
    CHECK(Z.value[0].real() == Approx(6.0).epsilon(1e-6));
    // Far above all else p = rho Sd/(2 pi) a at 1 m with a = Bl u/(j w Le m): no flight, -90 degrees.
    const double expected = 2.83 / 20e-6 * 1.2 * 0.0133 / (2.0 * std::numbers::pi) * 5.0
                            / (2.0 * std::numbers::pi * 20000.0 * 3e-4 * 0.01);
    CHECK(std::abs(sound.value[0]) == Approx(expected).epsilon(0.05));
    CHECK(std::arg(sound.value[0]) == Approx(-0.5 * std::numbers::pi).margin(0.2));
    CHECK_THROWS_AS(soundCurve({model, true, false}, {100.0}), Error);
    CHECK_THROWS_AS(soundCurve({model, false, true}, {100.0}), Error);
    CHECK_THROWS_AS(curveFrequencies(0.0, 100.0), Error);
    CHECK_THROWS_AS(impedanceCurve(makeModel("mechanical"), {100.0}), Error);
}

TEST_CASE("Played quietly a model has its linear impedance, played loudly another one", "[datasheet]")
{
    const auto model = bent();
    const auto quiet = impedanceCurve(playedAt(model, 1e-3, 30.0, 1000.0)),
               loud = impedanceCurve(playedAt(model, 8.0, 30.0, 1000.0));
    const auto linear = impedanceCurve(model, quiet.frequency);
    double worst = 0.0, change = 0.0;
    for (std::size_t k = 0; k < quiet.value.size(); ++k) {
        worst = std::max(worst, std::abs(quiet.value[k] / linear.value[k] - 1.0));
        change = std::max(change, std::abs(loud.value[k] / linear.value[k] - 1.0));
    }
    CHECK(worst < 1e-3);
    CHECK(change > 0.05);
    const auto take = playedAt(model, 2.0, 30.0, 1000.0);
    CHECK_THROWS_WITH(impedanceCurve(take, 5.0), Catch::Contains("it has 2"));
    CHECK_NOTHROW(impedanceCurve(take, 2.1));
}

TEST_CASE("A netlist is plain ASCII and says what it leaves out", "[datasheet]")
{
    const auto text = spiceNetlist(bent(), "12 \u00b5 woofer");
    for (const char c : text)
        CHECK((c == '\n' || (c >= 32 && c < 127)));
    CHECK_THAT(
        text,
        Catch::Contains(".SUBCKT d12____woofer plus minus cone\n")
            && Catch::Contains(
                "Left out, as they are no linear part of coil and cone: stiffness, force-factor, inductance-current")
            && Catch::EndsWith(".ENDS d12____woofer\n"));
    CHECK(text.find("\n.END\n") == std::string::npos);  // a name cannot end the deck
    CHECK_THAT(spiceNetlist(makeModel("mechanical"), ""), Catch::Contains(".SUBCKT driver cone\n"));
}
