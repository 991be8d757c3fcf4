// SPDX-License-Identifier: GPL-3.0-or-later
// How residuals bend along a step, against slopes on both sides of it: along one parameter
//     J_k^T r'' = (d/dtheta_k J_k^T J_k)/2.
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FeedbackError.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/StepCurvature.h"
#include "SeedDriver.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace excursion;

TEST_CASE("The bend along a step is that of the slopes beside it", "[fit]")
{
    auto record = makeRecord(seedTake({{"stiffness", 0.3}}, {Quantity::current, Quantity::displacement}));
    auto model = startModel(record);
    adapt(record, model);
    model = withEffect(model, effectNamed("stiffness"), visitedRange(model, record, 3));
    const auto sections = estimationSections(record);
    FitOptions options;
    options.fed = true;
    REQUIRE(fit(model, record, sections, options).usable());

    const auto active = freeParameters(model);
    const auto P = static_cast<Eigen::Index>(active.size());
    const auto motions = settledMotions(model, record, sections, 2);
    const auto at = [&](const Eigen::VectorXd& theta) {
        auto moved = model;
        const auto all = parametersOf(moved);
        for (Eigen::Index k = 0; k < P; ++k)
            all[static_cast<std::size_t>(active[static_cast<std::size_t>(k)])]->value = theta[k];
        return moved;
    };
    OutputErrorOptions run;
    run.spectra = run.slopes = true;
    const auto fitsAt = [&](const Eigen::VectorXd& theta) {
        return feedbackError(at(theta), record, sections, motions, active, run);
    };
    Eigen::VectorXd theta(P);
    for (Eigen::Index k = 0; k < P; ++k)
        theta[k] = parameterVector(model)[active[static_cast<std::size_t>(k)]];
    StepCurvature curvature(record, sections, fitsAt);
    curvature.beginAt(fitsAt(theta));
    const Eigen::VectorXd free = Eigen::VectorXd::Constant(P, std::numeric_limits<double>::infinity());
    const auto N = [&](const Eigen::VectorXd& where) { return sumOf(fitsAt(where))->N; };
    int bends = 0;
    for (Eigen::Index k = 0; k < P; ++k) {
        INFO(parametersOf(model)[static_cast<std::size_t>(active[static_cast<std::size_t>(k)])]->name);
        const Eigen::VectorXd step = 1e-3 * theta[k] * Eigen::VectorXd::Unit(P, k);
        const auto pull = curvature.along(theta, step, -free, free);
        REQUIRE(pull.size() == P);
        const double beside = 0.25 * (N(theta + step)(k, k) - N(theta - step)(k, k)) * step[k];
        const double whole = N(theta)(k, k) * step[k] * step[k];
        CHECK(pull[k] == Approx(beside).epsilon(0.01).margin(1e-5 * whole));
        bends += std::abs(beside) > 1e-4 * whole;
        // Held by a bound behind it, it does not move, and nothing bends.
        const Eigen::VectorXd bound = theta - 1e-6 * step;
        CHECK(curvature.along(theta, step, bound.cwiseMin(theta), bound.cwiseMax(theta)).isZero(0.0));
    }
    CHECK(bends >= 3);  // else there was nothing to see: strengths of laws are straight
}
