// SPDX-License-Identifier: GPL-3.0-or-later
// NARX models against recursions written out by hand, and their fits against systems that are known.
#include "Engine/Linear/StateSpace.h"
#include "Engine/Polynomial/Narx/NarxFile.h"
#include "Engine/Polynomial/Narx/NarxFit.h"
#include "Engine/Polynomial/Narx/NarxRecursion.h"
#include "Engine/Polynomial/InputOutputRecord.h"
#include "DocumentFile.h"
#include "Linear/Problem.h"
#include "Polynomial/Silverbox.h"

#include <nlohmann/json.hpp>

using namespace excursion;
using namespace excursion::test;
using Eigen::Index;

namespace {

double byHand(double y1, double y2, double u, double u1)
{
    return 1.5 * y1 - 0.7 * y2 + 0.2 * u + 0.3 * u1 - 0.05 * y1 * y1 * y1 + 0.1 * y2 * u1 + 0.02;
}

/// The same, of y(t-1), y(t-2), u(t-1), u(t).
Narx example()
{
    Narx model {1000.0, 2, 1, Exponents(7, 4), Eigen::VectorXd(7)};
    model.exponents << 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 3, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0;
    model.coefficients << 1.5, -0.7, 0.2, 0.3, -0.05, 0.1, 0.02;
    return model;
}

Eigen::MatrixXd white(Index N, double rms, Normal& normal)
{
    Eigen::MatrixXd u(N, 1);
    for (auto& x : u.reshaped())
        x = rms * normal();
    return u;
}

Eigen::MatrixXd recursion(const Eigen::MatrixXd& u)
{
    Eigen::MatrixXd y(u.rows(), 1);
    double y1 = 0, y2 = 0, u1 = 0;
    for (Index t = 0; t < u.rows(); ++t) {
        y(t, 0) = byHand(y1, y2, u(t, 0), u1);
        y2 = y1;
        y1 = y(t, 0);
        u1 = u(t, 0);
    }
    return y;
}

}  // namespace

TEST_CASE("A NARX model answers as its recursion, and so does the PNLSS model that it is")
{
    Normal normal(1);
    const auto u = white(500, 0.4, normal);
    const auto model = example();
    REQUIRE(model.isValid());
    CHECK(model.parameters() == 7);
    const auto truth = recursion(u), y = simulate(model, u);
    CHECK((y - truth).norm() < 1e-13 * truth.norm());
    const auto pnlss = pnlssOf(model);
    REQUIRE(pnlss.isValid());
    CHECK(pnlss.linear.order() == 3);
    CHECK(pnlss.terms() == 3);
    CHECK((simulate(pnlss, u) - truth).norm() < 1e-13 * truth.norm());
    CHECK(isStable(model));  // z^2 - 1.5 z + 0.7: poles of size 0.84
    auto wild = model;
    wild.coefficients[0] = 1.8;  // z^2 - 1.8 z + 0.7: a pole at 1.13
    CHECK_FALSE(isStable(wild));
    wild.coefficients[4] = 0.5;
    const auto lost = simulate(wild, u);
    CHECK_FALSE(std::isfinite(lost(499, 0)));
    CHECK(std::isfinite(lost(0, 0)));

    // Without past outputs, and without past inputs
    Narx plain {1000.0, 0, 1, Exponents(2, 2), Eigen::Vector2d(2.0, 3.0)};
    plain.exponents << 1, 0, 0, 2;
    const auto z = simulate(plain, u);
    CHECK(z(7, 0) == Approx(2.0 * u(6, 0) + 3.0 * u(7, 0) * u(7, 0)));
    CHECK((simulate(pnlssOf(plain), u) - z).norm() < 1e-13 * z.norm());
    Narx echo {1000.0, 1, 0, Exponents(2, 2), Eigen::Vector2d(0.5, 1.0)};
    echo.exponents << 1, 0, 0, 1;
    const auto e = simulate(echo, u);
    CHECK(e(2, 0) == Approx(0.25 * u(0, 0) + 0.5 * u(1, 0) + u(2, 0)));
    CHECK((simulate(pnlssOf(echo), u) - e).norm() < 1e-13 * e.norm());
}

TEST_CASE("The derivatives of a NARX simulation are those of finite differences")
{
    Normal normal(2);
    const auto model = example();
    const Eigen::VectorXd u = white(600, 0.4, normal);  // more than two blocks
    const NarxRecursion compiled(model);
    Eigen::VectorXd y, up, down;
    REQUIRE(compiled.run(model.coefficients, u, 1e6, y) == 600);
    Eigen::MatrixXd J(600, 7);
    compiled.differentiate(model.coefficients, u, y,
                           [&](Index first, const Eigen::MatrixXd& d) { J.middleRows(first, d.rows()) = d; });
    for (Index c = 0; c < 7; ++c) {
        Eigen::VectorXd moved = model.coefficients;
        moved[c] += 1e-6;
        compiled.run(moved, u, 1e6, up);
        moved[c] -= 2e-6;
        compiled.run(moved, u, 1e6, down);
        const Eigen::VectorXd numeric = (up - down) / 2e-6;
        CHECK((numeric - J.col(c)).norm() < 1e-7 * numeric.norm());
    }
    CHECK(compiled.run(1e3 * model.coefficients, u, 1e6, y) < 600);
}

TEST_CASE("The terms of a NARX system are found among a hundred, one after the other, and its coefficients exactly")
{
    Normal normal(3);
    const auto record = [&](Index N) {
        const auto u = white(N, 0.4, normal);
        return InputOutputRecord {u, recursion(u), 0, false};
    };
    const auto fit = fitNarx(1000.0, {record(800), record(500)}, {record(400)},
                             {.outputLags = 3, .inputLags = 3, .degree = 3});
    CHECK(fit.validationDb < -200.0);
    CHECK(fit.stable);
    REQUIRE(fit.steps.size() >= 7);
    // Each of the true terms is among those chosen, and all others have nothing to explain.
    const auto truth = example();
    int found = 0;
    for (Index k = 0; k < fit.model.parameters(); ++k) {
        double expected = 0.0;
        const Eigen::RowVectorXi e = fit.model.exponents.row(k);
        for (Index j = 0; j < truth.parameters(); ++j)  // lags 3 and 2 of more
            if (e.head(2) == truth.exponents.row(j).head(2) && e[2] == 0 && e[3] == truth.exponents(j, 2)
                && e.segment(4, 2).isZero() && e[6] == truth.exponents(j, 3)) {
                expected = truth.coefficients[j];
                ++found;
            }
        CHECK(fit.model.coefficients[k] == Approx(expected).margin(1e-8));
    }
    CHECK(found == 7);
    double sum = 0.0;
    for (const auto& step : fit.steps)
        sum += step.errorReduction;
    CHECK(sum == Approx(1.0).margin(1e-9));
}

TEST_CASE("Refinement takes away the bias that noise in the past outputs makes")
{
    Normal normal(4);
    const auto record = [&](Index N, double noise) {
        const auto u = white(N, 0.4, normal);
        Eigen::MatrixXd y = recursion(u);
        y += white(N, noise * y.norm() / std::sqrt(static_cast<double>(N)), normal);
        return InputOutputRecord {u, y, 20, false};
    };
    const std::vector estimation {record(4000, 0.03)}, validation {record(2000, 0.03)}, clean {record(2000, 0.0)};
    NarxFitOptions options {.outputLags = 2, .inputLags = 1, .degree = 3, .maximumTerms = 12, .maximumIterations = 0};
    const auto predicted = fitNarx(1000.0, estimation, validation, options);
    options.maximumIterations = 30;
    const auto refined = fitNarx(1000.0, estimation, validation, options);
    const double before = simulationErrorDb(predicted.model, clean), after = simulationErrorDb(refined.model, clean);
    CHECK(after < before - 10.0);
    CHECK(after < -46.0);
    CHECK(refined.estimationDb == Approx(20.0 * std::log10(0.03)).margin(0.5));
    CHECK(refined.stable);
}

TEST_CASE("A NARX fit of the Silverbox is told by its simulation")
{
    const Silverbox box;
    if (box.input.size() == 0)
        return;
    const auto fit = fitNarx(box.rate, {box.multisines()}, {box.lastMultisine()},
                             {.outputLags = 2, .inputLags = 2, .maximumTerms = 20});
    const auto arrow = box.arrow();
    const double relative = std::pow(10.0, simulationErrorDb(fit.model, {arrow}) / 20.0);
    const double millivolts = 1e3 * relative * arrow.output.bottomRows(39000).norm() / std::sqrt(39000.0);
    CHECK(fit.stable);
    CHECK(fit.validationDb < -45.0);
    CHECK(millivolts < 0.45);
}

TEST_CASE("Records and options that no NARX model can be fitted to are refused")
{
    Normal normal(9);
    const auto u = white(50, 1.0, normal);
    const auto no = [&](Error::Kind kind, const char* what, const std::vector<InputOutputRecord>& records,
                        const NarxFitOptions& options) {
        refused(kind, what, [&] { fitNarx(1000.0, records, {}, options); });
    };
    no(Error::Kind::usage, "lags", {{u, u, 0, false}}, {.outputLags = -1});
    no(Error::Kind::usage, "own time", {{u, u, 0, false}}, {.inputLags = 0, .direct = false});
    no(Error::Kind::usage, "degree", {{u, u, 0, false}}, {.degree = 0});
    no(Error::Kind::usage, "one term", {{u, u, 0, false}}, {.maximumTerms = 0});
    no(Error::Kind::usage, "1000", {{u, u, 0, false}}, {.outputLags = 9, .inputLags = 9, .degree = 3});
    no(Error::Kind::data, "no record", {}, {});
    no(Error::Kind::data, "does not fit", {{u, u.topRows(5), 0, false}}, {});
    no(Error::Kind::data, "explains", {{u, 0.0 * u, 0, false}}, {});
    refused(Error::Kind::usage, "sample rate", [&] { fitNarx(0.0, {{u, u, 0, false}}, {}); });
    refused(Error::Kind::usage, "one input", [&] { simulate(example(), Eigen::MatrixXd::Zero(3, 2)); });
    auto broken = example();
    broken.exponents.conservativeResize(7, 3);
    refused(Error::Kind::usage, "exponent", [&] { simulate(broken, u); });
}

TEST_CASE("A NARX model is kept and read again, bit for bit, and what does not fit is refused")
{
    const auto model = example();
    const DocumentFile file(toJson(Named<Narx> {"box", "voltage", "displacement", model}), narxFromJson);
    const auto read = file.read().model;
    CHECK(read.exponents == model.exponents);
    CHECK((read.coefficients.array() == model.coefficients.array()).all());
    CHECK(read.outputLags == 2);
    CHECK(read.inputLags == 1);
    file.refuses("terms[1].exponents", [](auto& d) { d["terms"][1]["exponents"].erase(0); });
    file.refuses("terms[2].exponents[0]", [](auto& d) { d["terms"][2]["exponents"][0] = -1; });
    file.refuses("terms[0].coefficient", [](auto& d) { d["terms"][0]["coefficient"] = nullptr; });
    file.refuses("outputLags", [](auto& d) { d["outputLags"] = 2.5; });
    file.refuses("sampleRate", [](auto& d) { d["sampleRate"] = -1; });
}
