// SPDX-License-Identifier: GPL-3.0-or-later
// Monomials, models, their recursion and its derivatives, against definitions and finite differences.
#include "Engine/Polynomial/Pnlss/PnlssFile.h"
#include "Engine/Polynomial/Pnlss/Recursion.h"
#include "DocumentFile.h"
#include "Linear/Problem.h"

#include <nlohmann/json.hpp>

#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Eigen::Index;

namespace {

/// A stable model with m inputs and p outputs and all coefficients of E and F drawn.
Pnlss drawn(int n, int m, int p, int degree, TermMask mask = TermMask::full, bool offset = false)
{
    Normal normal(static_cast<std::uint64_t>(100 * n + 10 * m + p));
    StateSpace linear;
    linear.sampleRate = 1.0;
    linear.A = Eigen::MatrixXd::Zero(n, n);
    for (int i = 0; i < n; ++i) {
        linear.A(i, i) = 0.8 - 0.1 * i;
        if (i + 1 < n)
            linear.A(i, i + 1) = 0.2;
    }
    linear.B.resize(n, m);
    linear.C.resize(p, n);
    linear.D.resize(p, m);
    for (auto* M : {&linear.B, &linear.C, &linear.D})
        for (auto& x : M->reshaped())
            x = 0.5 * normal();
    auto model = withTerms(linear, degree, mask, offset);
    for (Index k = 0; k < model.terms(); ++k) {
        for (Index i = 0; i < n; ++i)
            model.E(i, k) = model.free(i, k) ? 0.02 * normal() : 0.0;
        for (Index o = 0; o < p; ++o)
            model.F(o, k) = model.free(n + o, k) ? 0.02 * normal() : 0.0;
    }
    return model;
}

Eigen::MatrixXd noise(Index N, Index columns)
{
    Normal normal(77);
    Eigen::MatrixXd u(N, columns);
    for (auto& x : u.reshaped())
        x = 0.5 * normal();
    return u;
}

}  // namespace

TEST_CASE("Monomials are graded, then lexicographic, and as many as there are ways")
{
    Exponents expected(7, 2);
    expected << 2, 0, 1, 1, 0, 2, 3, 0, 2, 1, 1, 2, 0, 3;
    CHECK(monomials(2, 2, 3) == expected);
    CHECK(monomials(4, 2, 3).rows() == 30);           // (4+3 over 3) - 1 - 4
    CHECK(monomials(77, 2, 3).rows() == 82160 - 78);  // (80 over 3) - 1 - 77
    refused(Error::Kind::usage, "million", [] { monomials(100, 2, 5); });
    refused(Error::Kind::usage, "ascend", [] { monomials(3, 3, 2); });
}

TEST_CASE("Monomials are read from words")
{
    const auto read = monomialsNamed("x1^3, x2*u ,u2^2*x1,1,x1*x1", 2, 2);
    Exponents expected(5, 4);
    expected << 3, 0, 0, 0, 0, 1, 1, 0, 1, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0;
    CHECK(read == expected);
    for (const char* bad :
         {"", "x1,", "x", "x0", "x3", "u3", "y1", "x1^0", "x1^-2", "x1^99", "x1^2x2", "x1**x2", "x1^", "2"}) {
        CAPTURE(bad);
        refused(Error::Kind::usage, "cannot be read", [&] { monomialsNamed(bad, 2, 2); });
    }
}

TEST_CASE("Masks keep what they say")
{
    const auto all = monomials(3, 2, 3);  // x1, x2, u
    const auto states = allowed(TermMask::statesOnly, all, 2, 1);
    const auto pure = allowed(TermMask::noCrossProducts, all, 2, 1);
    const auto diagonal = allowed(TermMask::diagonal, all, 2, 1);
    CHECK(states.row(0).count() == 7);
    CHECK(pure.row(0).count() == 6);
    CHECK(diagonal.row(0).count() == 2);
    CHECK(diagonal.row(1).count() == 2);
    CHECK(diagonal.row(2).count() == 4);
    CHECK(allowed(TermMask::full, all, 2, 1).all());
    const auto model = withTerms(drawn(2, 1, 1, 2).linear, 3, TermMask::diagonal);
    CHECK(model.terms() == 4);  // those that no row uses are left out
    refused(Error::Kind::usage, "at least 2", [&] { withTerms(model.linear, 1); });
}

TEST_CASE("The compiled recursion simulates as the definition does, and its Jacobian is exact")
{
    struct Shape {
        int n, m, p, degree;
        TermMask mask;
        bool offset;
    };
    for (const auto& s :
         {Shape {1, 1, 1, 3, TermMask::full, false}, Shape {2, 1, 1, 3, TermMask::full, true},
          Shape {3, 1, 1, 3, TermMask::full, false}, Shape {3, 2, 2, 2, TermMask::statesOnly, false},
          Shape {4, 1, 2, 3, TermMask::diagonal, false}, Shape {6, 1, 1, 2, TermMask::noCrossProducts, true},
          Shape {6, 2, 2, 2, TermMask::noCrossProducts, false}}) {
        INFO(s.n << " states, " << s.m << " inputs, " << s.p << " outputs, degree " << s.degree);
        const auto model = drawn(s.n, s.m, s.p, s.degree, s.mask, s.offset);
        const Index N = 601;  // more than one block, and no multiple of four
        const auto u = noise(N, s.m);
        const Eigen::VectorXd x0 = Eigen::VectorXd::LinSpaced(s.n, -0.2, 0.3);
        const Recursion recursion(model, true);
        Eigen::MatrixXd states, outputs;
        REQUIRE(recursion.run(model, u, x0, 1e6, states, outputs));
        const auto reference = simulate(model, u, x0);
        CHECK((outputs - reference).norm() < 1e-14 * reference.norm());

        std::vector<Eigen::MatrixXd> J(static_cast<std::size_t>(s.p), Eigen::MatrixXd(N, recursion.parameters() + s.n));
        recursion.differentiate(model, u, states, [&](Index first, std::vector<Eigen::MatrixXd>& d) {
            for (std::size_t o = 0; o < J.size(); ++o)
                J[o].middleRows(first, d[o].rows()) = d[o];
        });
        const auto values = recursion.valuesOf(model);
        const double h = 1e-5;
        for (Index c = 0; c < recursion.parameters() + s.n; ++c) {
            auto up = model, down = model;
            Eigen::VectorXd xUp = x0, xDown = x0;
            if (c < recursion.parameters()) {
                auto v = values;
                v[c] += h;
                recursion.setValues(up, v);
                v[c] -= 2.0 * h;
                recursion.setValues(down, v);
            } else {
                xUp[c - recursion.parameters()] += h;
                xDown[c - recursion.parameters()] -= h;
            }
            const Eigen::MatrixXd numeric = (simulate(up, u, xUp) - simulate(down, u, xDown)) / (2.0 * h);
            for (std::size_t o = 0; o < J.size(); ++o) {
                const double size = std::max(numeric.norm(), 1e-9);
                CHECK((numeric.col(static_cast<Index>(o)) - J[o].col(c)).norm() < 1e-6 * size);
            }
        }
    }
}

TEST_CASE("A guided recursion and its Jacobian follow the measured output")
{
    const auto model = drawn(3, 1, 1, 2);
    const auto u = noise(300, 1), y = noise(300, 1);
    const Recursion recursion(model, true);
    const Recursion::Guide guide {Eigen::Vector3d(0.3, -0.1, 0.2), &y};
    Eigen::MatrixXd states, outputs, upStates, up, down;
    REQUIRE(recursion.run(model, u, Eigen::Vector3d::Zero(), 1e6, states, outputs, &guide));
    // The next state is the model's, plus the gain times what the output missed.
    const auto one = simulate(model, u.middleRows(9, 2), states.col(9));
    const auto plain = simulate(model, u.middleRows(10, 1), states.col(10));
    CHECK(outputs(9, 0) == Approx(one(0, 0)));
    CHECK(outputs(10, 0) == Approx(plain(0, 0)));
    CHECK(outputs(10, 0) != Approx(one(1, 0)));
    Eigen::MatrixXd J(300, recursion.parameters() + 3);
    recursion.differentiate(
        model, u, states,
        [&](Index first, std::vector<Eigen::MatrixXd>& d) { J.middleRows(first, d[0].rows()) = d[0]; }, &guide);
    const auto values = recursion.valuesOf(model);
    for (Index c = 0; c < recursion.parameters(); ++c) {
        auto moved = model;
        auto v = values;
        v[c] += 1e-5;
        recursion.setValues(moved, v);
        REQUIRE(recursion.run(moved, u, Eigen::Vector3d::Zero(), 1e6, upStates, up, &guide));
        v[c] -= 2e-5;
        recursion.setValues(moved, v);
        REQUIRE(recursion.run(moved, u, Eigen::Vector3d::Zero(), 1e6, upStates, down, &guide));
        const Eigen::VectorXd numeric = (up - down) / 2e-5;
        CHECK((numeric - J.col(c)).norm() < 1e-6 * std::max(numeric.norm(), 1e-9));
    }
}

TEST_CASE("Weights of the outputs are pulled back to the parameters as by the Jacobian's transpose")
{
    const auto model = drawn(3, 2, 2, 3);
    const Eigen::MatrixXd u = 0.3 * noise(599, 2), y = noise(599, 2), w = y.colwise().reverse();
    const Recursion recursion(model, true);
    const Recursion::Guide observer {0.1 * Eigen::MatrixXd::Random(3, 2), &y};
    for (const Recursion::Guide* guide : {static_cast<const Recursion::Guide*>(nullptr), &observer}) {
        Eigen::MatrixXd states, outputs;
        REQUIRE(recursion.run(model, u, Eigen::Vector3d(0.1, -0.2, 0.1), 1e6, states, outputs, guide));
        Eigen::VectorXd expected = Eigen::VectorXd::Zero(recursion.parameters() + 3);
        recursion.differentiate(
            model, u, states,
            [&](Index first, std::vector<Eigen::MatrixXd>& J) {
                for (Index o = 0; o < 2; ++o)
                    expected += J[static_cast<std::size_t>(o)].transpose() * w.col(o).segment(first, J[0].rows());
            },
            guide);
        const auto found = recursion.pullBack(model, u, states, w, guide);
        CHECK((found - expected).norm() < 1e-12 * expected.norm());
    }
}

TEST_CASE("A model that runs away is stopped at its bound")
{
    auto model = drawn(2, 1, 1, 2);
    model.linear.A *= 2.0;
    Eigen::MatrixXd states, outputs;
    CHECK_FALSE(Recursion(model, false).run(model, noise(5000, 1), Eigen::Vector2d::Zero(), 1e3, states, outputs));
}

namespace {

/// The Duffing oscillator of [B 4.10] with its example's figures, by Euler's rule. The cubic term belongs to the
/// displacement, where the state-space form printed there has the velocity.
struct Duffing {
    double Ts, m = 14.35e-3, r = 0.786, k = 1852.0, q2 = 3.33e5;

    Pnlss model() const
    {
        StateSpace linear;
        linear.sampleRate = 1.0 / Ts;
        linear.A.resize(2, 2);
        linear.A << 1.0, Ts, -k * Ts / m, 1.0 - r * Ts / m;
        linear.B = Eigen::Vector2d(0.0, Ts / m);
        linear.C = Eigen::RowVector2d(1.0, 0.0);
        linear.D = Eigen::MatrixXd::Zero(1, 1);
        auto result = withTerms(linear, 3, TermMask::diagonal);
        for (Index t = 0; t < result.terms(); ++t)
            if (result.exponents(t, 0) == 3)
                result.E(1, t) = -k * q2 * Ts / m;
        return result;
    }

    Eigen::MatrixXd drive(double amplitude, double seconds) const
    {
        Eigen::MatrixXd u(static_cast<Index>(seconds / Ts), 1);
        for (Index t = 0; t < u.rows(); ++t)
            u(t, 0) = amplitude * std::sin(2.0 * std::numbers::pi * 56.0 * static_cast<double>(t) * Ts);
        return u;
    }

    Eigen::VectorXd direct(const Eigen::MatrixXd& u) const
    {
        double x = 0.0, v = 0.0;
        Eigen::VectorXd y(u.rows());
        for (Index t = 0; t < u.rows(); ++t) {
            y[t] = x;
            const double a = (u(t, 0) - r * v - k * (1.0 + q2 * x * x) * x) / m;
            x += Ts * v;
            v += Ts * a;
        }
        return y;
    }
};

}  // namespace

TEST_CASE("The Duffing oscillator of the seed is such a model")
{
    const Duffing coarse {1.0 / 44100.0};
    const auto u = coarse.drive(9.0, 1.0);
    const auto strong = simulate(coarse.model(), u);
    CHECK((strong - coarse.direct(u)).norm() < 1e-9 * strong.norm());
    CHECK(strong.cwiseAbs().maxCoeff() > 1e-3);
    // At 100 N the stiffened spring is too fast for Euler's rule at 44.1 kHz, which feeds it energy until it runs away:
    // the recursion says so.
    const auto loud = coarse.drive(100.0, 1.0);
    Eigen::MatrixXd states, outputs;
    CHECK_FALSE(
        Recursion(coarse.model(), false).run(coarse.model(), loud, Eigen::Vector2d::Zero(), 1e6, states, outputs));
    // Ten times as fast it is bounded.
    const Duffing fine {1.0 / 441000.0};
    const auto y = simulate(fine.model(), fine.drive(100.0, 0.5));
    CHECK(y.allFinite());
    CHECK(y.cwiseAbs().maxCoeff() > 4e-3);
    CHECK(y.cwiseAbs().maxCoeff() < 0.02);
}

namespace {

/// The Van der Pol oscillator of [B 4.11] by Euler's rule.
Pnlss vanDerPol(double e, double Ts)
{
    StateSpace linear;
    linear.sampleRate = 1.0 / Ts;
    linear.A.resize(2, 2);
    linear.A << 1.0, Ts, -Ts, 1.0 + e * Ts;
    linear.B = Eigen::Vector2d(0.0, Ts);
    linear.C = Eigen::RowVector2d(1.0, 0.0);
    linear.D = Eigen::MatrixXd::Zero(1, 1);
    auto model = withTerms(linear, 3, TermMask::statesOnly);
    for (Index k = 0; k < model.terms(); ++k)
        if (model.exponents(k, 0) == 2 && model.exponents(k, 1) == 1)
            model.E(1, k) = -e * Ts;
    return model;
}

}  // namespace

TEST_CASE("The Van der Pol oscillator of the seed is such a model, unstable at rest and bounded")
{
    const double e = 8.53, Ts = 2e-4;
    const auto model = vanDerPol(e, Ts);
    CHECK_FALSE(isStable(model.linear));
    const Index N = static_cast<Index>(120.0 / Ts);
    const auto y = simulate(model, Eigen::MatrixXd::Zero(N, 1), Eigen::Vector2d(1.0, 0.0));
    CHECK(y.bottomRows(N / 2).cwiseAbs().maxCoeff() == Approx(2.014).margin(0.01));  // near 2 for any e
    // The period of a relaxation oscillation (Dorodnitsyn 1947)
    std::vector<double> up;
    for (Index t = N / 4; t + 1 < N; ++t)
        if (y(t, 0) < 0.0 && y(t + 1, 0) >= 0.0)
            up.push_back(static_cast<double>(t) * Ts);
    REQUIRE(up.size() > 2);
    const double measured = (up.back() - up.front()) / static_cast<double>(up.size() - 1);
    const double period = (3.0 - 2.0 * std::log(2.0)) * e + 7.01432 / std::cbrt(e) - 22.0 / 9.0 * std::log(e) / e;
    CHECK(measured == Approx(period).epsilon(0.02));

    // Driven as in the example of [B 4.1.3]: bounded, though its linear part grows without bound.
    const auto driven = vanDerPol(e, 0.01);
    Eigen::MatrixXd u(60000, 1);
    for (Index t = 0; t < u.rows(); ++t)
        u(t, 0) = 1.2 * std::sin(2.0 * std::numbers::pi / 10.0 * static_cast<double>(t) * 0.01);
    CHECK(simulate(driven, u).cwiseAbs().maxCoeff() < 3.0);
}

TEST_CASE("A change of states changes nothing that can be measured")
{
    const auto model = drawn(3, 1, 2, 3, TermMask::statesOnly, true);
    Eigen::Matrix3d T;
    T << 1.5, 0.3, -0.2, 0.1, 0.7, 0.4, -0.5, 0.2, 2.0;
    const auto other = transformed(model, T);
    REQUIRE(other.isValid());
    const auto u = noise(400, 1);
    const auto y = simulate(model, u), z = simulate(other, u);
    CHECK((y - z).norm() < 1e-11 * y.norm());
}

TEST_CASE("A PNLSS model is kept and read again, bit for bit, and what does not fit is refused")
{
    const auto model = drawn(3, 1, 1, 3, TermMask::diagonal, true);
    const DocumentFile file(toJson(NamedPnlss {"box", {"voltage"}, {"current"}, model}), pnlssFromJson);
    const auto read = file.read().model;
    CHECK(read.exponents == model.exponents);
    CHECK((read.E.array() == model.E.array()).all());
    CHECK((read.F.array() == model.F.array()).all());
    CHECK((read.free == model.free).all());
    const auto u = noise(100, 1);
    CHECK((simulate(read, u).array() == simulate(model, u).array()).all());
    file.refuses("terms[1].E", [](auto& d) { d["terms"][1]["E"].erase(0); });
    file.refuses("terms[0].exponents", [](auto& d) { d["terms"][0]["exponents"] = {0, 1, 0, 0}; });
    file.refuses("terms[2].free", [](auto& d) { d["terms"][2]["free"].push_back(true); });
    file.refuses("sampleRate", [](auto& d) { d["linear"]["sampleRate"] = 0; });
    file.refuses("linear.A", [](auto& d) { d["linear"]["A"].erase(0); });
}
