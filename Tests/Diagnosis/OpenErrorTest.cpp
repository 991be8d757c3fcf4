// SPDX-License-Identifier: GPL-3.0-or-later
#include "SmallSetup.h"

#include "Bench/Bench.h"
#include "Engine/Diagnosis/Compare.h"
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/Fit.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace excursion;

TEST_CASE("What parameters leave open of the sections that were fitted is one unit a parameter", "[diagnosis]")
{
    // The trace of J C J^T over all rows is that of C N, with C = chi^2 N^-1.
    const auto record = makeRecord(bench::measure({}, smallSetup()));
    auto model = startModel(record);
    auto fitted = record;
    adapt(fitted, model);
    const auto summary = fit(model, fitted, estimationSections(fitted));
    REQUIRE(summary.usable());
    model.covariance = model.inverseCurvature;  // as if the noise of each channel were its own
    double sum = 0.0;
    for (const auto section : estimationSections(fitted))
        for (const auto& open : openError(model, fitted, section))
            sum += open.chiSquared;
    double told = 0.0;
    for (Eigen::Index k = 0; k < model.covariance.rows(); ++k)
        told += model.covariance(k, k) > 0.0;
    CHECK(sum == Approx(std::max(1.0, summary.chiSquaredPerValue) * told).epsilon(0.02));
    model.covariance.resize(0, 0);
    CHECK(openError(model, fitted, 0).front().chiSquared == 0.0);
}

TEST_CASE("What laws leave open knows units as far apart as newtons a metre and henries", "[diagnosis]")
{
    // Priors hold what little the take tells, so a parameter leaves at most one unit.
    auto setup = smallSetup();
    setup.excitation.levels = {8.0};
    auto record = makeRecord(bench::measure({}, setup));
    auto model = startModel(record);
    adapt(record, model);
    for (const char* effect : {"stiffness", "inductance-position", "force-factor"})
        model = withEffect(std::move(model), effectNamed(effect), visitedRange(model, record));
    const auto summary = fit(model, record, estimationSections(record));
    REQUIRE(summary.usable());
    double sum = 0.0, told = 0.0;
    for (const auto section : estimationSections(record))
        for (const auto& open : openError(model, record, section))
            sum += open.chiSquared;
    for (Eigen::Index k = 0; k < model.covariance.rows(); ++k)
        told += model.covariance(k, k) > 0.0;
    const double unit = std::max(1.0, summary.chiSquaredPerValue);
    CHECK(sum > 0.3 * unit * told);
    CHECK(sum < 1.1 * unit * told);
    // A direction that the data does not see has no variance, and hides no other.
    model.covariance.row(5).setConstant(0.0);
    model.covariance.col(5).setConstant(0.0);
    model.covariance(5, 5) = std::nan("");
    CHECK(openError(model, record, 0).front().chiSquared > 0.0);
}

TEST_CASE("An error may have what three standard errors of the parameters leave, and no more", "[diagnosis]")
{
    ErrorLevel error;
    error.db = -55.0;
    error.noiseFloorDb = -60.0;
    error.chiSquaredPerValue = 1.8;
    CHECK(!isNoise(error));
    error.openChiSquared = 0.1;
    error.openPower = 0.1;  // 2 + 0.9 times the noise is less than 5 dB
    CHECK(!isNoise(error));
    error.openPower = 0.15;
    CHECK(isNoise(error));
    error.openChiSquared = 0.01;
    CHECK(!isNoise(error));
    error.noiseFloorDb.reset();
    CHECK(!isNoise(error));
}
