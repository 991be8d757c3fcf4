// SPDX-License-Identifier: GPL-3.0-or-later
// Smaller models: their bounds, their exact points, and the best direct fits as a measure.
#include "Engine/Linear/Bilinear.h"
#include "Engine/Linear/Identify.h"
#include "Engine/Linear/Reduction.h"
#include "Engine/Linear/Response.h"
#include "Linear/Problem.h"

#include <cmath>

using namespace excursion;
using namespace excursion::test;
using Complex = std::complex<double>;

namespace {

StateSpace manyPoles(double rate)
{
    std::vector<Complex> roots;
    for (int k = 0; k < 5; ++k) {
        const Complex s(-40.0 - 30.0 * k, 300.0 * (k + 1));
        const Complex root = rate == 0.0 ? s : std::exp(s / rate);
        roots.push_back(root);
        roots.push_back(std::conj(root));
    }
    const auto sections = sectionsOf(roots, rate, rate == 0.0 ? 1000.0 : 1.0);
    Eigen::MatrixXd C(1, 10);
    C << 1, 0.5, 0.3, -0.4, 0.1, 0.2, -0.02, 0.05, 0.01, -0.01;
    return realize(sections, C, Eigen::VectorXd::Constant(1, 0.1));
}

double worst(const StateSpace& a, const StateSpace& b)
{
    double largest = 0.0;
    for (int k = 0; k < 2000; ++k)
        largest = std::max(largest, std::abs(respond(a, {0.25 * k})[0](0, 0) - respond(b, {0.25 * k})[0](0, 0)));
    return largest;
}

}  // namespace

TEST_CASE("A balanced model keeps its response, and a truncated one its bound")
{
    for (const double rate : {0.0, 1000.0}) {
        const auto model = manyPoles(rate);
        const auto found = balanced(model);
        REQUIRE(found.singularValues.size() == 10);
        CHECK(worst(model, found.model) < 1e-10 * found.singularValues[0]);
        // Both Gramians are diag(sigma): A W A^T - W = -B B^T, or A W + W A^T = -B B^T
        const Eigen::MatrixXd W = found.singularValues.asDiagonal();
        const auto& m = found.model;
        const Eigen::MatrixXd reached = rate == 0.0 ? Eigen::MatrixXd(m.A * W + W * m.A.transpose())
                                                    : Eigen::MatrixXd(m.A * W * m.A.transpose() - W);
        const Eigen::MatrixXd seen = rate == 0.0 ? Eigen::MatrixXd(m.A.transpose() * W + W * m.A)
                                                 : Eigen::MatrixXd(m.A.transpose() * W * m.A - W);
        CHECK((reached + m.B * m.B.transpose()).norm() < 1e-9 * (m.B * m.B.transpose()).norm());
        CHECK((seen + m.C.transpose() * m.C).norm() < 1e-9 * (m.C.transpose() * m.C).norm());
        for (const Eigen::Index order : {2, 4, 6, 8})
            for (const auto how : {Truncation::direct, Truncation::singularPerturbation}) {
                const auto small = truncated(found, order, how);
                CHECK(small.order() == order);
                CHECK(isStable(small));
                CHECK(worst(model, small) <= truncationBound(found, order) * (1.0 + 1e-9));
                // no model of that order comes nearer than sigma itself
                CHECK(worst(model, small) >= found.singularValues[order] * 0.95);
                if (how == Truncation::singularPerturbation)
                    CHECK(std::abs(respond(model, {0.0})[0](0, 0) - respond(small, {0.0})[0](0, 0))
                          < 1e-10 * found.singularValues[0]);
            }
        CHECK(truncationBound(found, 10) == 0.0);
    }
    auto unstable = manyPoles(1000.0);
    unstable.A *= 1.5;
    refused(Error::Kind::data, "stable", [&] { balanced(unstable); });
}

TEST_CASE("Pruning stops before its bound, and ends where a direct fit would", "[slow]")
{
    const auto frf = problemResponse("P3ii.csv");
    if (frf.frequency.empty())
        return;
    const auto data = frequencyDataOf(frf);
    IdentifyOptions options;
    options.order = 76;
    const auto large = identify(data, options);
    REQUIRE(large.sections);
    const auto start = fitPartialFractions(*large.sections, data);

    PruningOptions bounded;
    bounded.errorDb = -30.0;
    bounded.refinementIterations = 3;
    const auto kept = prune(start, data, bounded);
    CHECK(kept.reason == "the next step would pass the bound of the error");
    CHECK(kept.steps.back().errorDb <= -30.0);
    CHECK(kept.fit.sections.order() < 67);
    CHECK(isStable(kept.fit.sections));

    PruningOptions wanted;
    wanted.order = 22;
    const auto pruned = prune(start, data, wanted);
    CHECK(pruned.fit.sections.order() == 22);
    CHECK(isStable(pruned.fit.sections));
    const double reached = judged(realize(pruned.fit.sections, pruned.fit.C, pruned.fit.D), data).errorDb;
    CHECK(reached <= -15.3);  // and the best direct fit of that order is at -15.5 dB
    for (std::size_t k = 1; k < pruned.steps.size(); ++k)
        CHECK(pruned.steps[k].order < pruned.steps[k - 1].order);
}
