// SPDX-License-Identifier: GPL-3.0-or-later
// Models of order 20 and degree 3, as a whole loudspeaker asks for: with all monomials they would have 42483
// parameters, with few they are fitted.
#include "Engine/Polynomial/Pnlss/PnlssFit.h"
#include "Linear/Problem.h"

#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Eigen::Index;

namespace {

constexpr Index order = 20;

/// Ten resonances in parallel, each a rotation, the first of them by far the strongest, at 8 kHz.
StateSpace tenResonances()
{
    StateSpace linear;
    linear.sampleRate = 8000.0;
    linear.A = Eigen::MatrixXd::Zero(order, order);
    linear.B = Eigen::MatrixXd::Zero(order, 1);
    linear.C = Eigen::MatrixXd::Zero(1, order);
    linear.D = Eigen::MatrixXd::Constant(1, 1, 0.05);
    for (Index i = 0; i < order / 2; ++i) {
        const double angle = 2.0 * std::numbers::pi * 60.0 * std::pow(1.65, static_cast<double>(i)) / linear.sampleRate,
                     radius = 1.0 - 0.12 * angle;
        linear.A.block(2 * i, 2 * i, 2, 2) << radius * std::cos(angle), radius * std::sin(angle),
            -radius * std::sin(angle), radius * std::cos(angle);
        linear.B(2 * i + 1, 0) = 0.5 * std::sqrt(angle);
        linear.C(0, 2 * i) = i == 0 ? 1.0 : (i % 2 == 0 ? 0.15 : -0.15);
    }
    return linear;
}

/// The recursion written out by itself, one sample and one monomial after the other.
Eigen::VectorXd simulated(const Pnlss& m, const Eigen::VectorXd& u)
{
    Eigen::VectorXd x = Eigen::VectorXd::Zero(order), y(u.size());
    for (Index t = 0; t < u.size(); ++t) {
        Eigen::VectorXd p(m.terms());
        for (Index k = 0; k < m.terms(); ++k) {
            p[k] = std::pow(u[t], m.exponents(k, order));
            for (Index i = 0; i < order; ++i)
                p[k] *= std::pow(x[i], m.exponents(k, i));
        }
        y[t] = m.linear.C.row(0).dot(x) + m.linear.D(0, 0) * u[t] + m.F.row(0).dot(p);
        x = (m.linear.A * x + m.linear.B * u[t] + m.E * p).eval();
    }
    return y;
}

/// A steady period of noise in, and what comes out with noise added.
InputOutputRecord periodOf(const Pnlss& truth, Index N, double noiseDb, Normal& normal)
{
    Eigen::VectorXd u(N);
    for (auto& x : u)
        x = 0.4 * normal();
    Eigen::VectorXd y = simulated(truth, u.replicate(3, 1)).tail(N);
    const double size = std::pow(10.0, noiseDb / 20.0) * y.norm() / std::sqrt(static_cast<double>(N));
    for (auto& x : y)
        x += size * normal();
    return periodicRecord(u, y, 2560);
}

}  // namespace

TEST_CASE("A chosen list of monomials is what a model has, and lists that make no model are refused")
{
    const auto linear = tenResonances();
    Exponents chosen = Exponents::Zero(3, order + 1);
    chosen(0, 0) = 3;
    chosen(1, 4) = chosen(1, order) = 1;
    const auto model = withTerms(linear, chosen);  // the third is an offset
    REQUIRE(model.isValid());
    CHECK(model.exponents == chosen);
    CHECK(model.free.all());
    CHECK(model.E.isZero());
    CHECK(model.F.cols() == 3);
    CHECK(withTerms(linear, Exponents(0, order + 1)).terms() == 0);

    auto bad = chosen;
    bad.row(2) = bad.row(0);
    refused(Error::Kind::usage, "number 3 of the list occurs twice", [&] { withTerms(linear, bad); });
    bad.row(2).setZero();
    bad(2, 7) = 1;
    refused(Error::Kind::usage, "degree that is not 1", [&] { withTerms(linear, bad); });
    bad(2, 7) = -2;
    refused(Error::Kind::usage, "at least 0", [&] { withTerms(linear, bad); });
    refused(Error::Kind::usage, "as many as", [&] { withTerms(linear, Exponents(chosen.leftCols(5))); });
    auto continuous = linear;
    continuous.sampleRate = 0.0;
    refused(Error::Kind::usage, "discrete time", [&] { withTerms(continuous, chosen); });
}

TEST_CASE("Order 20 with a chosen list of monomials is fitted down to the noise, linear part and all", "[slow]")
{
    // The first resonance hardens, and moves the gain of another: x1^2, x1^3, x1 x3.
    Exponents chosen = Exponents::Zero(3, order + 1);
    chosen(0, 0) = 2;
    chosen(1, 0) = 3;
    chosen(2, 0) = chosen(2, 2) = 1;
    auto truth = withTerms(tenResonances(), chosen);
    truth.E(1, 0) = 0.004;
    truth.E(1, 1) = -0.01;
    truth.E(3, 2) = 0.03;
    Normal normal(20);
    const auto estimation = periodOf(truth, 4096, -70.0, normal), validation = periodOf(truth, 2048, -400.0, normal);

    // A linear part that is a little off in every entry that is not zero.
    auto linear = tenResonances();
    for (auto* M : {&linear.A, &linear.B, &linear.C})
        for (auto& x : M->reshaped())
            x *= 1.0 + 1e-4 * normal();
    const auto start = withTerms(linear, chosen);
    PnlssFitOptions options;
    options.search = PnlssSearch::plain;
    options.maximumIterations = 14;
    const auto fit = fitPnlss(start, {estimation}, {validation}, options);
    CAPTURE(fit.iterations, fit.message, fit.history, fit.estimationDb, fit.validationDb);
    CHECK(relativeErrorDb(start, {validation}) > -20.0);
    CHECK(fit.estimationDb == Approx(-70.0).margin(0.7));
    CHECK(fit.validationDb < -80.0);
    CHECK(fit.stable);
}

TEST_CASE("Order 20, degree 3 without cross products runs to its end and fits", "[slow]")
{
    auto truth = withTerms(tenResonances(), 3, TermMask::noCrossProducts);
    REQUIRE(truth.terms() == 42);
    Normal normal(21);
    for (Index k = 0; k < truth.terms(); ++k)
        if (truth.exponents(k, order) == 0)
            for (Index i = 1; i < order; i += 2)
                truth.E(i, k) = (truth.exponents.row(k).sum() == 2 ? 0.003 : -0.004) * normal();
    const auto estimation = periodOf(truth, 6144, -60.0, normal), validation = periodOf(truth, 2048, -400.0, normal);
    for (const bool everywhere : {false, true}) {
        auto start = truth;
        start.E.setZero();
        if (!everywhere)  // forces act on velocities
            for (Index row = 0; row <= order; ++row)
                start.free.row(row).setConstant(row % 2 == 1);
        PnlssFitOptions options;
        options.linearFree = false;
        options.search = PnlssSearch::plain;
        options.maximumIterations = 12;
        const auto fit = fitPnlss(start, {estimation}, {validation}, options);
        CAPTURE(everywhere, fit.iterations, fit.message, fit.history, fit.estimationDb, fit.validationDb);
        CHECK(relativeErrorDb(start, {validation}) > -20.0);
        CHECK(fit.history.back() < -59.6);  // the noise is at -60 dB
        // 420 coefficients are told by 6144 samples; 882 are fitted to the noise as well, and extrapolate to the peaks
        // of another record.
        CHECK(fit.validationDb < (everywhere ? -58.0 : -68.0));
        CHECK(fit.stable);
    }
}
