// SPDX-License-Identifier: GPL-3.0-or-later
// Volterra kernels against closed forms, and against what simulations of two small tones hold.
#include "Engine/Polynomial/Volterra/VolterraSeriesFile.h"
#include "Engine/Signal/Fft.h"
#include "DocumentFile.h"
#include "Linear/Problem.h"

#include <nlohmann/json.hpp>

#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Complex = std::complex<double>;
using Eigen::Index;

namespace {

constexpr double rate = 1000.0;

Complex z(double f) { return std::polar(1.0, 2.0 * std::numbers::pi * f / rate); }

/// x(t+1) = a x + b u + terms, y = c x + terms of one state and input; coefficients of (x^i u^j) in the state and in
/// the output equation.
struct Term {
    int i, j;
    double state, output;
};
Pnlss scalar(double a, double b, double c, const std::vector<Term>& terms)
{
    Pnlss model;
    model.linear.sampleRate = rate;
    model.linear.A = Eigen::MatrixXd::Constant(1, 1, a);
    model.linear.B = Eigen::MatrixXd::Constant(1, 1, b);
    model.linear.C = Eigen::MatrixXd::Constant(1, 1, c);
    model.linear.D = Eigen::MatrixXd::Zero(1, 1);
    const auto K = static_cast<Index>(terms.size());
    model.exponents.resize(K, 2);
    model.E.resize(1, K);
    model.F.resize(1, K);
    model.free = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>::Constant(2, K, true);
    for (Index k = 0; k < K; ++k) {
        const auto& t = terms[static_cast<std::size_t>(k)];
        model.exponents.row(k) << t.i, t.j;
        model.E(0, k) = t.state;
        model.F(0, k) = t.output;
    }
    return model;
}

/// A stable model with all terms of degree 2 and 3 drawn, and an offset where asked for.
Pnlss drawnResonance(std::uint64_t seed, bool offset)
{
    Normal normal(seed);
    StateSpace linear;
    linear.sampleRate = rate;
    const double angle = 0.3 + 0.5 * std::abs(normal()), radius = 0.9 - 0.1 * std::abs(normal());
    linear.A.resize(2, 2);
    linear.A << std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle);
    linear.A *= radius;
    linear.B = Eigen::Vector2d(normal(), normal());
    linear.C = Eigen::RowVector2d(normal(), normal());
    linear.D = Eigen::MatrixXd::Constant(1, 1, 0.3 * normal());
    auto model = withTerms(linear, 3, TermMask::full, offset);
    for (auto* M : {&model.E, &model.F})
        for (auto& c : M->reshaped())
            c = 0.1 * normal();
    return model;
}

}  // namespace

TEST_CASE("Volterra kernels of one state are those found by hand")
{
    const double a = 0.7, b = 0.4, c = 1.3, e = 0.15, g = -0.08, f1 = 31.0, f2 = -130.0, f3 = 77.0;
    const auto G = [&](double f) { return b / (z(f) - a); };
    const auto near = [](Complex found, Complex truth) { CHECK(std::abs(found - truth) < 1e-13 * std::abs(truth)); };

    // Wiener: y = c x + e x^2 + g x^3
    const Volterra wiener(scalar(a, b, c, {{2, 0, 0.0, e}, {3, 0, 0.0, g}}));
    near(wiener.response({f1})[0], c * G(f1));
    near(wiener.response({f1, f2})[0], e * G(f1) * G(f2));
    near(wiener.response({f1, f2, f3})[0], g * G(f1) * G(f2) * G(f3));

    // Hammerstein: x+ = a x + b u + e u^2 + g u^3
    const Volterra hammerstein(scalar(a, b, c, {{0, 2, e, 0.0}, {0, 3, g, 0.0}}));
    near(hammerstein.response({f1, f2})[0], c * e / (z(f1 + f2) - a));
    near(hammerstein.response({f1, f2, f3})[0], c * g / (z(f1 + f2 + f3) - a));

    // Feedback: x+ = a x + b u + e x^2. x2 = e G G / (z12 - a), x3 of order 3 from 2 e x1 x2, symmetrized.
    const Volterra feedback(scalar(a, b, c, {{2, 0, e, 0.0}}));
    const auto X2 = [&](double p, double q) { return e * G(p) * G(q) / (z(p + q) - a); };
    near(feedback.response({f1, f2})[0], c * X2(f1, f2));
    near(feedback.response({f1, f2, f3})[0],
         c * e / (z(f1 + f2 + f3) - a) * (2.0 / 3.0) * (G(f1) * X2(f2, f3) + G(f2) * X2(f1, f3) + G(f3) * X2(f1, f2)));

    // Bilinear: x+ = a x + b u + e x u. X2 = e (G(f1) + G(f2)) / 2 / (z12 - a)
    const Volterra bilinear(scalar(a, b, c, {{1, 1, e, 0.0}}));
    near(bilinear.response({f1, f2})[0], c * 0.5 * e * (G(f1) + G(f2)) / (z(f1 + f2) - a));

    // A constant: x0 = a x0 + k + e x0^2; around it the pole is a + 2 e x0, the second kernel as above.
    const double k = 0.05, x0 = ((1.0 - a) - std::sqrt((1.0 - a) * (1.0 - a) - 4.0 * e * k)) / (2.0 * e),
                 pole = a + 2.0 * e * x0;
    const Volterra shifted(scalar(a, b, c, {{0, 0, k, 0.0}, {2, 0, e, 0.0}}));
    CHECK(shifted.rest()[0] == Approx(x0).epsilon(1e-12));
    CHECK(shifted.offset()[0] == Approx(c * x0).epsilon(1e-12));
    near(shifted.response({f1})[0], c * b / (z(f1) - pole));
    near(shifted.response({f1, f2})[0], c * e * b / (z(f1) - pole) * b / (z(f2) - pole) / (z(f1 + f2) - pole));
}

TEST_CASE("Harmonics and intermodulation of two small tones are what the kernels say")
{
    const auto seed = GENERATE(1u, 2u, 3u, 4u);
    const bool offset = seed > 2;
    INFO("seed " << seed);
    const auto model = drawnResonance(seed, offset);
    const Volterra kernels(model);
    const Index N = 1000;  // 1 Hz a line
    const int a = 37, b = 101;
    const double A = 4e-4, B = 3e-4, phaseA = 0.4, phaseB = -1.1;
    Eigen::MatrixXd u(N, 1);
    for (Index t = 0; t < N; ++t) {
        const double w = 2.0 * std::numbers::pi * static_cast<double>(t) / static_cast<double>(N);
        u(t, 0) = A * std::cos(a * w + phaseA) + B * std::cos(b * w + phaseB);
    }
    const Eigen::VectorXd y = simulate(model, u.replicate(2, 1), kernels.rest()).bottomRows(N);
    const auto Y = fft(std::span(y.data(), static_cast<std::size_t>(N)));
    // Complex amplitudes of exp(j w t) at +a and +b; at -a and -b their conjugates
    const auto amplitude = [&](int line) {
        const auto up = std::abs(line) == a ? std::polar(0.5 * A, phaseA) : std::polar(0.5 * B, phaseB);
        return line > 0 ? up : std::conj(up);
    };
    const auto expected = [&](const std::vector<int>& lines, double permutations) {
        Complex product = permutations;
        std::vector<double> f;
        for (const int line : lines) {
            product *= amplitude(line);
            f.push_back(line);
        }
        return product * kernels.response(f)[0];
    };
    struct Case {
        std::vector<int> lines;
        double permutations;
    };
    for (const auto& [lines, permutations] : {Case {{a}, 1},
                                              {{b}, 1},
                                              {{a, a}, 1},
                                              {{b, b}, 1},
                                              {{a, b}, 2},
                                              {{b, -a}, 2},
                                              {{a, a, a}, 1},
                                              {{a, a, b}, 3},
                                              {{b, b, -a}, 3},
                                              {{b, -a, -a}, 3},
                                              {{b, b, b}, 1}}) {
        int line = 0;
        for (const int l : lines)
            line += l;
        const auto found = Y[static_cast<std::size_t>(line)] / static_cast<double>(N);
        const auto truth = expected(lines, permutations);
        INFO("line " << line << " of order " << lines.size());
        CHECK(std::abs(found - truth) < (lines.size() == 3 ? 1e-4 : 1e-5) * std::abs(truth));
    }
}

TEST_CASE("What a truncated series leaves falls with the power of the amplitude that it should")
{
    const auto seed = GENERATE(5u, 6u, 7u);
    const auto model = drawnResonance(seed, seed == 7u);
    const Volterra kernels(model);
    Normal normal(seed);
    Eigen::MatrixXd u(400, 1);
    for (auto& x : u.reshaped())
        x = normal();
    for (int order = 1; order <= 3; ++order) {
        const auto remainder = [&](double amplitude) {
            Eigen::MatrixXd y = simulate(model, amplitude * u, kernels.rest());
            y.rowwise() -= kernels.offset().transpose();
            for (const auto& part : kernels.parts(amplitude * u, order))
                y -= part;
            return y.norm();
        };
        const double slope = std::log2(remainder(8e-3) / remainder(4e-3));
        CHECK(slope == Approx(order + 1).margin(0.02));
    }
    // Homogeneous: twice the input, 2^n times the part
    const auto once = kernels.parts(u, 3), twice = kernels.parts(2.0 * u, 3);
    for (int n = 1; n <= 3; ++n)
        CHECK((twice[static_cast<std::size_t>(n - 1)] - std::pow(2.0, n) * once[static_cast<std::size_t>(n - 1)]).norm()
              < 1e-10 * twice[static_cast<std::size_t>(n - 1)].norm());
}

TEST_CASE("Kernels in time and in frequency are transforms of one another, and their sum is the series")
{
    auto model = drawnResonance(8, true);
    model.linear.A *= 0.6;  // short memory
    const Volterra kernels(model);
    const auto series = volterraSeries(model, 60, 60, 30);
    REQUIRE(series.isValid());
    CHECK(series.parameters() == 1 + 60 + 60 * 61 / 2 + 30 * 31 * 32 / 6);
    const double f1 = 90.0, f2 = -210.0, f3 = 333.0;
    Complex H1, H2, H3;
    for (int i = 0; i < 60; ++i) {
        H1 += series.first[i] * std::pow(z(f1), -i);
        for (int j = 0; j < 60; ++j)
            H2 += series.second(i, j) * std::pow(z(f1), -i) * std::pow(z(f2), -j);
    }
    for (int i = 0; i < 30; ++i)
        for (int j = 0; j < 30; ++j)
            for (int k = 0; k < 30; ++k)
                H3 += series.third[static_cast<std::size_t>(i)](j, k) * std::pow(z(f1), -i) * std::pow(z(f2), -j)
                      * std::pow(z(f3), -k);
    CHECK(std::abs(H1 - kernels.response({f1})[0]) < 1e-9 * std::abs(H1));
    CHECK(std::abs(H2 - kernels.response({f1, f2})[0]) < 1e-9 * std::abs(H2));
    CHECK(std::abs(H3 - kernels.response({f3, f1, f2})[0]) < 1e-5 * std::abs(H3));

    Normal normal(1);
    Eigen::MatrixXd u(200, 1);
    for (auto& x : u.reshaped())
        x = normal();
    const auto parts = kernels.parts(u, 3);
    Eigen::MatrixXd sum = parts[0] + parts[1] + parts[2];
    sum.array() += kernels.offset()[0];
    CHECK((simulate(series, u) - sum).norm() < 1e-5 * sum.norm());
    // Two inputs: with alike columns the kernels must be those of one input
    auto two = model;
    two.linear.B = model.linear.B.replicate(1, 2);
    two.linear.D = model.linear.D.replicate(1, 2);
    two.exponents = Exponents::Zero(model.terms(), 4);
    two.exponents.leftCols(2) = model.exponents.leftCols(2);
    two.exponents.col(3) = model.exponents.col(2);  // the monomials know the second input only
    const Volterra both(two);
    CHECK(both.response({f1, f2}, {1, 1})[0] == kernels.response({f1, f2})[0]);
    const Complex mixed = both.response({f1, f2}, {0, 1})[0];
    CHECK(std::abs(mixed - both.response({f2, f1}, {1, 0})[0]) < 1e-14 * std::abs(mixed));
    refused(Error::Kind::usage, "one input", [&] { volterraSeries(two, 4, 4); });
    refused(Error::Kind::usage, "one of the model's", [&] { both.response({f1, f2}, {0, 2}); });
}

TEST_CASE("Models without Volterra kernels are told")
{
    refused(Error::Kind::data, "not stable", [] { Volterra {scalar(1.01, 1.0, 1.0, {{2, 0, 0.1, 0.0}})}; });
    // x = x/2 + 1 + x^2 has no real solution
    refused(Error::Kind::numerical, "rests", [] {
        Volterra {scalar(0.5, 1.0, 1.0, {{0, 0, 1.0, 0.0}, {2, 0, 1.0, 0.0}})};
    });
    const auto model = scalar(0.5, 1.0, 1.0, {{2, 0, 0.1, 0.0}});
    const Volterra kernels(model);
    refused(Error::Kind::usage, "orders", [&] { kernels.response({}); });
    refused(Error::Kind::usage, "orders", [&] { kernels.parts(Eigen::MatrixXd::Zero(3, 1), 0); });
    refused(Error::Kind::usage, "impulses", [&] { kernels.kernel({0, -1}, 5); });
    refused(Error::Kind::usage, "does not fit", [&] { kernels.parts(Eigen::MatrixXd::Zero(3, 2), 2); });
    refused(Error::Kind::usage, "memories", [&] { volterraSeries(model, 0, 3); });
    auto series = volterraSeries(model, 5, 3, 2);
    refused(Error::Kind::usage, "one input", [&] { simulate(series, Eigen::MatrixXd::Zero(3, 2)); });
    series.third[0](1, 0) += 1.0;
    refused(Error::Kind::usage, "symmetric", [&] { simulate(series, Eigen::MatrixXd::Zero(3, 1)); });
}

TEST_CASE("A Volterra series is kept and read again, bit for bit, and what does not fit is refused")
{
    const auto series = volterraSeries(drawnResonance(3, true), 12, 6, 4);
    const DocumentFile file(toJson(Named<VolterraSeries> {"box", "voltage", "displacement", series}),
                            volterraSeriesFromJson);
    const auto read = file.read().model;
    CHECK(read.first == series.first);
    CHECK(read.second == series.second);
    REQUIRE(read.third.size() == 4);
    CHECK(read.third[3] == series.third[3]);
    CHECK(read.offset == series.offset);
    file.refuses("first[2]", [](auto& d) { d["first"][2] = "x"; });
    file.refuses("second[1]", [](auto& d) { d["second"][1].erase(0); });
    file.refuses("third[0]", [](auto& d) { d["third"].erase(0); });
    file.refuses("symmetric", [](auto& d) { d["second"][0][1] = 17.0; });
    file.refuses("offset", [](auto& d) { d.erase("offset"); });
}
