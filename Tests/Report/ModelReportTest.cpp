// SPDX-License-Identifier: GPL-3.0-or-later
// Pages of models: what their pictures hold, against closed forms, and what has no page.
#include "Engine/Error.h"
#include "Engine/Linear/Response.h"
#include "Plots/ModelPlots.h"
#include "Report/ModelReport.h"
#include "Report/SampleDocuments.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

using namespace excursion;
using namespace excursion::test;
using std::numbers::pi;

TEST_CASE("Poles stand at their frequency and angle, in continuous and in discrete time, above the border exactly when "
          "they are stable")
{
    for (const double rate : {0.0, 48000.0}) {
        const auto plot = rootsPlot(resonance(80.0, 0.25, rate));
        CAPTURE(rate);
        REQUIRE(plot.series[0].title == "poles");
        REQUIRE(plot.series[0].x.size() == 2);  // one of the pair, and the gap
        CHECK(plot.series[0].x[0] == Approx(80.0).epsilon(1e-9));
        CHECK(plot.series[0].y[0] == Approx(180.0 - std::acos(0.25) * 180.0 / pi).epsilon(1e-9));
    }
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    int stable = 0;
    for (int k = 0; k < 60; ++k) {
        FractionalStateSpace model;
        model.alpha = 0.2 + 0.02 * k;
        model.form = resonance(50.0, 0.5);
        for (auto& value : model.form.A.reshaped())
            value = 200.0 * normal(random);
        const auto plot = rootsPlot(model.form, model.alpha);
        const double border = plot.series.back().y.front();
        bool above = true;
        for (const double angle : plot.series[0].y)
            above = above && !(angle <= border);
        CAPTURE(model.alpha);
        CHECK(above == isStable(model));
        stable += above;
    }
    CHECK(stable > 10);
    CHECK(stable < 50);
}

TEST_CASE("The first cut of the gain surface is the frequency response, and on the ray of a pole the gain has no bound")
{
    const auto model = resonance(80.0, std::cos(pi / 4.0));  // its poles lie on the ray of 135 degrees
    const auto plot = gainSurfacePlot(model);
    REQUIRE(plot.series.size() == 4);
    const auto response = respond(model, plot.series[0].x);
    for (std::size_t k = 0; k < response.size(); ++k)
        CHECK(plot.series[0].y[k] == Approx(20.0 * std::log10(std::abs(response[k](0, 0)))).margin(1e-6));
    const auto largest = [&](std::size_t ray) {
        return *std::max_element(plot.series[ray].y.begin(), plot.series[ray].y.end());
    };
    CHECK(largest(0) < 1.0);
    CHECK(largest(2) > 25.0);
    const auto sampled = gainSurfacePlot(resonance(80.0, 0.25, 8000.0));
    CHECK(sampled.series[0].x.back() <= 4000.0);
}

TEST_CASE("Every document that has a page makes one, and others are refused by what they are")
{
    const auto page = [](const nlohmann::json& document) { return documentHtml(JsonField(document, "", "test.json")); };
    const auto [linear, fractional, sweep, fractionalSweep, fit, ranking, halves, harmonics] = sampleDocuments();
    try {
        for (const auto& document : sampleDocuments().all()) {
            CAPTURE(document.at("format").get<std::string>());
            const auto html = page(document);
            CHECK(html.find("<svg") != std::string::npos);
            CHECK(html.find("<it>") == std::string::npos);
        }
        for (const char* told :
             {"ran &amp; away", "pnlss &amp; co", "nothing &lt;to&gt; correct", "\u221247.5", "1.10 %", "1.7 ms"})
            CHECK(page(ranking).find(told) != std::string::npos);
        CHECK(page(harmonics).find("At most 1.00 % of harmonics, in the pressure at 100 Hz") != std::string::npos);
        CHECK(page(harmonics).find("H2") != std::string::npos);
    } catch (const Error& e) {
        if (std::string(e.what()).find("gnuplot") == std::string::npos)
            throw;
        WARN("gnuplot is not installed; this test is skipped");
    }
    CHECK_THROWS_AS(page({{"format", "excursion-model"}, {"version", 1}}), Error);
    CHECK_THROWS_AS(page(nlohmann::json::object()), Error);
    auto newer = ranking;
    newer["version"] = 2;
    CHECK_THROWS_AS(page(newer), Error);
    auto shortened = harmonics;
    shortened["curves"][0]["thd"]["db"] = {-40.0};
    CHECK_THROWS_AS(page(shortened), Error);
    auto broken = sweep;
    broken["orders"][0].erase("errorDb");
    CHECK_THROWS_AS(page(broken), Error);
}

TEST_CASE("What identify, pnlss and rank found reads back from its document")
{
    const auto same = [](const nlohmann::json& document, const auto& from) {
        CAPTURE(document.at("format").get<std::string>());
        CHECK(nlohmann::json(toJson(from(JsonField(document, "", "test.json")))) == document);
    };
    const auto samples = sampleDocuments();
    same(samples.sweep, identificationFromJson);
    same(samples.fractionalSweep, fractionalIdentificationFromJson);
    same(samples.halves, motorConeFromJson);
    same(samples.fit, polynomialFitFromJson);
    same(samples.ranking, rankingFromJson);
    auto elsewhere = samples.sweep;
    elsewhere["chosen"] = 7;
    CHECK_THROWS_AS(identificationFromJson(JsonField(elsewhere, "", "test.json")), Error);
}

TEST_CASE("A class that ran away on what it had not seen is not drawn, and a fit that did not arrive is no good news")
{
    RankedModel sound;
    sound.name = "linear";
    sound.parameters = 7;
    sound.estimationDb = sound.validationDb = -30.0;
    sound.stable = true;
    auto lost = sound;
    lost.name = "narx";
    lost.estimationDb = -90.0;
    lost.validationDb = std::numeric_limits<double>::infinity();
    lost.stable = false;
    Ranking ranking;
    ranking.models = {sound, lost};
    ranking.sentence = "s";
    const nlohmann::json document(toJson(ranking));
    const auto read = rankingFromJson(JsonField(document, "", "the ranking"));
    CHECK(std::isinf(read.models[1].validationDb));
    CHECK(read.models[0].validationDb == -30.0);
    const auto page = documentHtml(JsonField(document, "", "the ranking"));
    CHECK(page.find("narx: it runs away on records that it is judged by, and is not drawn.") != std::string::npos);
    CHECK(page.find("linear: it runs away") == std::string::npos);

    PolynomialFit fit;
    fit.estimationDb = -20.0;
    fit.stable = true;
    fit.stopped = "the error no longer falls";
    fit.arrived = false;
    fit.advice = "Try a higher --order.";
    fit.model = {{"format", "excursion-block-model"}};
    const auto missed = [&fit] {
        const nlohmann::json told(toJson(fit));
        return documentHtml(JsonField(told, "", "the fit"));
    };
    CHECK(missed().find("the fit did not arrive at the noise") != std::string::npos);
    CHECK(missed().find("Try a higher --order.") != std::string::npos);
    fit.arrived.reset();
    CHECK(missed().find("it is not known whether that is the noise") != std::string::npos);
    fit.arrived = true;
    fit.advice.clear();
    CHECK(missed().find("arrive at the noise") == std::string::npos);
    CHECK(missed().find("not known whether") == std::string::npos);
}
