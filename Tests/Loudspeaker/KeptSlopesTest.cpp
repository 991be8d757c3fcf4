// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FeedbackError.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/KeptSlopes.h"
#include "SeedDriver.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace excursion;

TEST_CASE("The slopes of one place give the gradient at another where residuals are straight between them", "[fit]")
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
    KeptSlopes slopes(record, sections);
    const auto begin = fitsAt(theta);
    CHECK(slopes.gradientAt(begin).size() == 0);  // nothing is kept yet
    slopes.keep(begin);
    const auto here = *sumOf(begin);
    // Each parameter has its own unit, and so has its row: |J_k| |r|.
    const Eigen::ArrayXd scale = here.N.diagonal().array().sqrt() * std::sqrt(here.cost);
    CHECK(((slopes.gradientAt(begin) - here.g).array().abs() / scale).maxCoeff() < 1e-5);
    // Fed laws are straight in their coefficients: J^T r(theta + d) = g + N d.
    int straight = 0;
    for (Eigen::Index k = 0; k < P; ++k) {
        const auto& p = *parametersOf(model)[static_cast<std::size_t>(active[static_cast<std::size_t>(k)])];
        if (!p.strength)
            continue;
        INFO(p.name);
        const Eigen::VectorXd d = 0.3 * theta[k] * Eigen::VectorXd::Unit(P, k);
        const Eigen::VectorXd expected = here.g + here.N * d;
        const Eigen::ArrayXd change = here.N.diagonal().array().sqrt() * std::sqrt(here.N(k, k)) * d.norm();
        CHECK(((slopes.gradientAt(fitsAt(theta + d)) - expected).array().abs() / (1e-4 * change + 1e-5 * scale))
                  .maxCoeff()
              < 1.0);
        ++straight;
    }
    CHECK(straight >= 3);
}
