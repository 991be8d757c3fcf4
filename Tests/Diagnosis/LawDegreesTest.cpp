// SPDX-License-Identifier: GPL-3.0-or-later
#include "SeedDriver.h"

#include "Engine/Diagnosis/LawDegrees.h"
#include "Engine/Diagnosis/QuickFit.h"
#include "Engine/Diagnosis/RaiseDegrees.h"
#include "Engine/Diagnosis/Refine.h"
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Catalogue.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <tuple>
#include <utility>

using namespace excursion;

namespace {

/// A take of a bent suspension, and a model of it with a law of this degree, fitted by simulation.
struct Bent {
    Record record;
    Model model;
    FitSummary summary;
    FitOptions options;

    Bent(const char* effect, int degree, double strength)
        : record(makeRecord(seedTake({{effect, strength}}))), model(startModel(record))
    {
        adapt(record, model);
        model = withEffect(std::move(model), effectNamed(effect), visitedRange(model, record, degree));
        fitFurther();
        fitFurther();  // priors weigh as much as noise now, where the first fit began far above it
    }

    void fitFurther()
    {
        options.substeps = 2;
        options.gradientSubsteps = 2;
        options.search = {60, 1e-9};
        summary = fit(model, record, estimationSections(record), options);
        REQUIRE(summary.usable());
    }
};

}  // namespace

TEST_CASE("A law that gives coefficients back needs no other fit", "[diagnosis]")
{
    Bent high("stiffness", 10, 0.2);
    const auto before = high.summary;
    REQUIRE(tooHigh(high.model) == std::vector<std::size_t> {1});
    CHECK(highestCoefficients(high.model, 1).size() == 4);

    auto refitted = high;
    refitted.model = withDegree(std::move(refitted.model), 1, 6);
    refitted.fitFurther();

    const auto lower = withLowerLaw(high.model, 1);
    CHECK(lower.components[1].operatingRange.degree == 6);
    REQUIRE(parameterVector(lower).size() == parameterVector(refitted.model).size());
    const auto one = parametersOf(lower), other = parametersOf(std::as_const(refitted.model));
    int compared = 0;
    for (std::size_t k = 0; k < one.size(); ++k) {
        INFO(one[k]->name << ": " << one[k]->value << " and " << other[k]->value << " +- " << other[k]->standardError);
        CHECK(one[k]->free == other[k]->free);
        if (!(other[k]->standardError > 0.0))
            continue;
        ++compared;
        CHECK(std::abs(one[k]->value - other[k]->value) < 0.1 * other[k]->standardError);
        CHECK(one[k]->standardError == Approx(other[k]->standardError).epsilon(0.02));
    }
    CHECK(compared == 16);  // six of the base, six of the law, two lags and the displacement's corner

    lowerAsItPays(high.model, high.summary, high.record, estimationSections(high.record), high.options);
    CHECK(high.model.components[1].operatingRange.degree == 6);
    CHECK(high.summary.finalCost == Approx(refitted.summary.finalCost).epsilon(1e-5));
    CHECK(high.summary.finalCost > before.finalCost);
    CHECK(high.summary.chiSquaredPerValue == Approx(refitted.summary.chiSquaredPerValue).epsilon(1e-5));
}

TEST_CASE("A law keeps coefficients that a simulation misses, whatever the curvature says", "[diagnosis]")
{
    Bent strong("force-factor", 10, 0.6);
    REQUIRE(tooHigh(strong.model).empty());
    strong.model.inverseCurvature *= 1e8;  // as if the fit knew nothing
    REQUIRE(tooHigh(strong.model) == std::vector<std::size_t> {1});
    const auto before = strong.model;
    lowerAsItPays(strong.model, strong.summary, strong.record, estimationSections(strong.record), strong.options);
    CHECK(strong.model.components[1].operatingRange.degree == 10);
    CHECK(parameterVector(strong.model) == parameterVector(before));
}

TEST_CASE("The last fit gives a law the coefficients that it lacks, and no others", "[diagnosis]")
{
    for (const auto& [effect, strength, degree] : {std::tuple {"force-factor", 0.6, 10}, {"stiffness", 0.2, 6}}) {
        CAPTURE(effect);
        Bent bent(effect, 6, strength);
        const auto before = bent.summary;
        const auto after = fitBySimulation(bent.model, bent.record, {}, true);  // with steps of its own choice
        REQUIRE(after.usable());
        CHECK(after.substeps > 0);
        CHECK(after.finalCost <= before.finalCost + 1.0);
        CHECK(bent.model.components[1].operatingRange.degree == degree);
        for (const auto& p : bent.model.components[1].parameters)
            CHECK((!p.free || std::isfinite(p.standardError)));
    }
}

TEST_CASE("A law goes beyond the 18th degree near the noise alone", "[diagnosis]")
{
    // Rms(v) for friction: each degree brings something, as none is the law.
    auto record = makeRecord(seedTake({{"friction", 0.3}}));
    const auto* damping = &effectNamed("damping-velocity");
    const auto raisedFrom = [&](int degree) {
        auto model = startModel(record);
        adapt(record, model);
        model = withEffect(std::move(model), *damping, visitedRange(model, record, degree));
        FitOptions options;
        options.substeps = 1;
        options.search = {15, 1e-4};
        const auto summary = fitFed(model, record, estimationSections(record), options);
        REQUIRE(summary.usable());
        UNSCOPED_INFO("chi-square " << summary.chiSquaredPerValue << " of degree " << degree);
        raiseDegrees(model, record, {});
        return model.components[1].operatingRange.degree;
    };
    CHECK(raisedFrom(6) == 10);
    CHECK(raisedFrom(18) == 18);
    for (auto& section : record.sections)  // of sensors so noisy that the same law leaves little beside it
        for (auto& channel : section.deviation)
            for (double& deviation : channel)
                deviation *= 30.0;
    CHECK(raisedFrom(18) == 22);
    record.noiseKnown = false;
    CHECK(raisedFrom(18) == 18);
}

TEST_CASE("A law that runs away where no fit has been is expanded less", "[diagnosis]")
{
    Bent wild("stiffness", 14, 0.2);
    int loudest = 0;
    for (const auto& section : wild.record.sections)
        loudest = std::max(loudest, section.level);
    for (auto& section : wild.record.sections)  // the fit sees the cone move less far than the law reaches
        section.validation = section.level == loudest;
    wild.fitFurther();
    const auto leaves = [&](const std::vector<std::size_t>& sections) {
        const auto sum = quickSum(wild.model, wild.record, sections, wild.options);
        REQUIRE(sum);
        return sum->cost / sum->rows;
    };
    const auto seen = estimationSections(wild.record), unseen = validationSections(wild.record);
    const double before = leaves(unseen);
    REQUIRE(before > 2.0 * leaves(seen));
    lowerAsUnseenTells(wild.model, wild.summary, wild.record, seen, wild.options);
    CHECK(wild.model.components[1].operatingRange.degree < 14);
    CHECK(leaves(unseen) < 0.5 * before);
    CHECK(leaves(seen) < 1.1);
    CHECK(wild.summary.chiSquaredPerValue == Approx(leaves(seen)).epsilon(0.02));
    const auto settled = wild.model;
    lowerAsUnseenTells(wild.model, wild.summary, wild.record, seen, wild.options);
    CHECK(parameterVector(wild.model) == parameterVector(settled));
}
