// SPDX-License-Identifier: GPL-3.0-or-later
// Unstable models: their parts, their mirror images, their causal projections, and what a constrained fit makes of
// them.
#include "Engine/Linear/Decomposition.h"
#include "Engine/Linear/Identify.h"
#include "Engine/Linear/Response.h"
#include "Engine/Linear/Stabilization.h"
#include "Engine/Numerics/Sylvester.h"
#include "Linear/Problem.h"

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Complex = std::complex<double>;

namespace {

/// Poles and their partial fractions are known; then the model is taken into a random basis.
struct Known {
    std::vector<Complex> poles, residues;  ///< of one output and input, closed under conjugation
    double direct = 0.0;
    StateSpace model;

    Complex at(Complex s) const
    {
        Complex g = direct;
        for (std::size_t k = 0; k < poles.size(); ++k)
            g += residues[k] / (s - poles[k]);
        return g;
    }
    /// The part of the poles of one kind, without the direct term.
    Complex part(Complex s, bool stable) const
    {
        Complex g = 0.0;
        for (std::size_t k = 0; k < poles.size(); ++k)
            if ((model.continuous() ? poles[k].real() < 0.0 : std::abs(poles[k]) < 1.0) == stable)
                g += residues[k] / (s - poles[k]);
        return g;
    }
};

Known known(const std::vector<Complex>& upper, const std::vector<Complex>& residues, double direct, double rate,
            Normal& normal)
{
    Known k;
    k.direct = direct;
    const auto n = static_cast<Eigen::Index>(
        std::count_if(upper.begin(), upper.end(), [](Complex p) { return p.imag() > 0.0; }) + upper.size());
    auto& m = k.model;
    m.sampleRate = rate;
    m.A = Eigen::MatrixXd::Zero(n, n);
    m.B = Eigen::MatrixXd::Zero(n, 1);
    m.C = Eigen::MatrixXd::Zero(1, n);
    m.D = Eigen::MatrixXd::Constant(1, 1, direct);
    Eigen::Index at = 0;
    for (std::size_t i = 0; i < upper.size(); ++i) {
        const auto p = upper[i], r = residues[i];
        k.poles.push_back(p);
        k.residues.push_back(r);
        if (p.imag() == 0.0) {
            m.A(at, at) = p.real();
            m.B(at, 0) = 1.0;
            m.C(0, at++) = r.real();
            continue;
        }
        k.poles.push_back(std::conj(p));
        k.residues.push_back(std::conj(r));
        // x = x1 + j x2 with x' = p x + u, y = 2 Re(r x)
        m.A.block(at, at, 2, 2) << p.real(), -p.imag(), p.imag(), p.real();
        m.B(at, 0) = 1.0;
        m.C(0, at) = 2.0 * r.real();
        m.C(0, at + 1) = -2.0 * r.imag();
        at += 2;
    }
    Eigen::MatrixXd T = Eigen::MatrixXd::Identity(n, n);
    for (auto& t : T.reshaped())
        t += 0.2 * normal();
    m = transformed(m, T);
    return k;
}

Known mixed(double rate, Normal& normal)
{
    if (rate == 0.0)
        return known({{-3, 40}, {5, 25}, {-60, 0}, {12, 0}, {-1, 7}}, {{2, 5}, {1, -4}, {30, 0}, {-8, 0}, {0.4, 0.2}},
                     0.7, 0.0, normal);
    return known({{0.5, 0.7}, {0.9, 0.55}, {-0.4, 0}, {1.3, 0}, {0.97, 0.1}},
                 {{0.2, 0.1}, {0.3, -0.2}, {1, 0}, {-0.4, 0}, {0.02, 0.01}}, 0.7, rate, normal);
}

std::vector<double> grid(double rate)
{
    std::vector<double> f;
    for (int k = 0; k < 400; ++k)
        f.push_back(rate == 0.0 ? 0.05 * k : rate * k / 798.0);
    return f;
}

Complex pointOf(double f, double rate)
{
    const double omega = 2.0 * std::numbers::pi * f;
    return rate == 0.0 ? Complex(0.0, omega) : std::polar(1.0, omega / rate);
}

}  // namespace

TEST_CASE("A Sylvester equation is solved to rounding, and one without solution is refused")
{
    Normal normal(1);
    Eigen::MatrixXd A(5, 5), B(3, 3), X(5, 3);
    for (auto* M : {&A, &B, &X})
        for (auto& x : M->reshaped())
            x = normal();
    B.diagonal().array() += 10.0;
    const Eigen::MatrixXd C = A * X - X * B;
    CHECK((solveSylvester(A, B, C) - X).norm() < 1e-13 * X.norm());
    refused(Error::Kind::numerical, "share an eigenvalue", [&] { solveSylvester(A, A, Eigen::MatrixXd::Ones(5, 5)); });
    refused(Error::Kind::usage, "do not fit", [&] { solveSylvester(A, B, A); });
}

TEST_CASE("A model is the sum of its stable and its unstable part")
{
    Normal normal(2);
    for (const double rate : {0.0, 1000.0})
        for (int trial = 0; trial < 20; ++trial) {
            const auto truth = mixed(rate, normal);
            const auto parts = decomposed(truth.model);
            REQUIRE(parts.stable.order() == 5);
            REQUIRE(parts.unstable.order() == 3);
            CHECK(isStable(parts.stable));
            for (const auto& p : poles(parts.unstable))
                CHECK((rate == 0.0 ? p.real() : std::abs(p) - 1.0) > 0.0);
            const auto f = grid(rate);
            const auto whole = respond(truth.model, f), stable = respond(parts.stable, f),
                       unstable = respond(parts.unstable, f);
            double largest = 0.0, sumError = 0.0, stableError = 0.0, unstableError = 0.0;
            for (std::size_t k = 0; k < f.size(); ++k) {
                const auto s = pointOf(f[k], rate);
                largest = std::max(largest, std::abs(truth.at(s)));
                sumError = std::max(sumError, std::abs(stable[k](0, 0) + unstable[k](0, 0) - truth.at(s)));
                stableError = std::max(stableError, std::abs(stable[k](0, 0) - truth.direct - truth.part(s, true)));
                unstableError = std::max(unstableError, std::abs(unstable[k](0, 0) - truth.part(s, false)));
            }
            CHECK(sumError < 1e-12 * largest);
            CHECK(stableError < 1e-12 * largest);
            CHECK(unstableError < 1e-12 * largest);
            const auto again = respond(sum(parts.stable, parts.unstable), {f[100]});
            CHECK(std::abs(again[0](0, 0) - whole[100](0, 0)) < 1e-12 * largest);
        }
}

TEST_CASE("Decomposition does not mind a multiple pole, or poles of a single kind")
{
    Normal normal(3);
    // Three equal unstable poles in a Jordan block, where eigenvectors would not exist.
    StateSpace chain;
    chain.A = Eigen::MatrixXd::Zero(5, 5);
    chain.A << 2, 1, 0, 0, 0, 0, 2, 1, 0, 0, 0, 0, 2, 1, 0, 0, 0, 0, -3, 1, 0, 0, 0, 0, -3;
    chain.B = Eigen::MatrixXd::Zero(5, 1);
    chain.B(4, 0) = 1.0;
    chain.C = Eigen::MatrixXd::Zero(1, 5);
    chain.C(0, 0) = 1.0;
    chain.D = Eigen::MatrixXd::Zero(1, 1);
    // G = 1 / ((s - 2)^3 (s + 3)^2); about s = -3: 1/(s - 2)^3 = -1/125 - 3/625 (s + 3) - ..
    const auto parts = decomposed(chain);
    REQUIRE(parts.stable.order() == 2);
    for (const double f : {0.0, 0.1, 1.0, 30.0}) {
        const Complex s(0.0, 2.0 * std::numbers::pi * f), t = s + 3.0;
        const Complex expected = -1.0 / 125.0 / (t * t) - 3.0 / 625.0 / t;
        CHECK(std::abs(respond(parts.stable, {f})[0](0, 0) - expected) < 1e-13);
    }
    const auto onlyStable = decomposed(known({{-1, 2}}, {{1, 1}}, 0.3, 0.0, normal).model);
    CHECK(onlyStable.unstable.order() == 0);
    CHECK(onlyStable.coupling == 0.0);
    const auto onlyUnstable = decomposed(known({{1.1, 0}}, {{1, 0}}, 0.3, 100.0, normal).model);
    CHECK(onlyUnstable.stable.order() == 0);
    CHECK(onlyUnstable.stable.D(0, 0) == 0.3);
    StateSpace broken;
    refused(Error::Kind::usage, "needs an input", [&] { decomposed(broken); });
}

TEST_CASE("Mirrored poles are the images of the unstable ones; magnitudes and zeros stay")
{
    Normal normal(4);
    for (const double rate : {0.0, 1000.0}) {
        const auto truth = mixed(rate, normal);
        const auto image = mirroredByAllPass(truth.model);
        CHECK(isStable(image));
        REQUIRE(image.order() == 8);
        auto expected = truth.poles;
        for (auto& p : expected)
            if (rate == 0.0)
                p = {-std::abs(p.real()), p.imag()};
            else if (std::abs(p) > 1.0)
                p = 1.0 / std::conj(p);
        for (const auto& p : expected) {
            double nearest = 1e9;
            for (const auto& q : poles(image))
                nearest = std::min(nearest, std::abs(p - q));
            CHECK(nearest < 1e-10 * std::abs(p));
        }
        const auto f = grid(rate);
        const auto responses = respond(image, f);
        double worst = 0.0, moved = 0.0;
        for (std::size_t k = 0; k < f.size(); ++k) {
            const auto g = truth.at(pointOf(f[k], rate));
            worst = std::max(worst, std::abs(std::abs(responses[k](0, 0)) / std::abs(g) - 1.0));
            moved = std::max(moved, std::abs(responses[k](0, 0) / g - 1.0));
        }
        CHECK(worst < 1e-11);
        CHECK(moved > 0.5);  // the phase does not stay
        const auto before = zeros(truth.model), after = zeros(image);
        REQUIRE(before.size() == after.size());
        for (std::size_t k = 0; k < before.size(); ++k)
            CHECK(std::abs(before[k] - after[k]) < 1e-7 * std::abs(before[k]));
    }
    // [B 6.25 to 6.27]: H = 1/(1 - p/z), whose image is p^-1/(1 - 1/(p z)) up to sign.
    const double p = 1.25;
    const auto single = known({{p, 0}}, {{p, 0}}, 1.0, 1.0, normal);  // z/(z - p) = 1 + p/(z - p)
    for (const double f : {0.0, 0.1, 0.37, 0.5}) {
        const auto z = pointOf(f, 1.0);
        const Complex expected = (1.0 / p) * z / (z - 1.0 / p);
        const auto found = respond(mirroredByAllPass(single.model), {f})[0](0, 0);
        CHECK(std::min(std::abs(found - expected), std::abs(found + expected)) < 1e-13);
    }
}

TEST_CASE("Mirroring keeps the magnitudes of several outputs, or of several inputs, and lands inside from the border")
{
    Normal normal(5);
    auto wide = mixed(0.0, normal).model;
    wide.C = Eigen::MatrixXd(3, 8);
    for (auto& c : wide.C.reshaped())
        c = normal();
    wide.D = Eigen::MatrixXd::Ones(3, 1);
    auto tall = wide;
    tall.A.transposeInPlace();
    tall.B = wide.C.transpose();
    tall.C = wide.B.transpose();
    tall.D = wide.D.transpose();
    for (const auto& model : {wide, tall}) {
        const auto image = mirroredByAllPass(model);
        CHECK(isStable(image));
        for (const double f : {0.0, 1.0, 4.0, 20.0}) {
            const auto a = respond(model, {f})[0], b = respond(image, {f})[0];
            CHECK((a.cwiseAbs() - b.cwiseAbs()).norm() < 1e-10 * a.norm());
        }
    }
    // A sum, y(t+1) = y(t) + u(t): its pole is on the border.
    StateSpace border;
    border.A = border.B = border.C = Eigen::MatrixXd::Ones(1, 1);
    border.D = Eigen::MatrixXd::Zero(1, 1);
    border.sampleRate = 48000.0;
    CHECK(decomposed(border).unstable.order() == 1);
    CHECK(isStable(mirroredByAllPass(border)));
    CHECK(std::abs(respond(mirroredByAllPass(border), {1000.0})[0](0, 0))
          == Approx(std::abs(respond(border, {1000.0})[0](0, 0))).epsilon(1e-6));
}

TEST_CASE("The projection leaves the anticausal energy out and no more, and a delay makes that fall as |p|^-d")
{
    Normal normal(6);
    const double p = 1.2, c = 0.8, rate = 1.0;
    const auto truth = known({{p, 0}, {0.6, 0.3}}, {{c, 0}, {0.3, 0.1}}, 0.2, rate, normal);
    for (const Eigen::Index delay : {0, 1, 2, 5, 10}) {
        const auto image = stableProjection(truth.model, delay);
        REQUIRE(isStable(image));
        CHECK(image.order() == 2 + delay);
        // Mean square over the whole circle, by a sum that is exact to |p|^-2048: the responses' squares are smooth and
        // periodic.
        double energy = 0.0;
        const int N = 2048;
        for (int k = 0; k < N; ++k) {
            const auto z = std::polar(1.0, 2.0 * std::numbers::pi * k / N);
            const auto f = static_cast<double>(k <= N / 2 ? k : N - k) / N;
            auto found = respond(image, {f})[0](0, 0);
            if (k > N / 2)
                found = std::conj(found);
            energy += std::norm(found - truth.at(z) * std::pow(z, -static_cast<double>(delay))) / N;
        }
        // sum over k > d of (c p^-(k+1))^2
        const double expected = c * c * std::pow(p, -2.0 * static_cast<double>(delay + 2)) / (1.0 - 1.0 / (p * p));
        CHECK(energy == Approx(expected).epsilon(1e-9));
    }
    refused(Error::Kind::usage, "discrete time", [&] { stableProjection(mixed(0.0, normal).model, 1); });
}

namespace {

/// A stable loudspeaker-like response with noise, and a model of too high an order fitted to it without constraint.
struct Measured {
    Known truth;
    FrequencyData data, clean;
    LinearIdentification free;
};

Measured measured(double rate, std::uint64_t seed)
{
    Normal normal(seed);
    Measured m;
    const double unit = 2.0 * std::numbers::pi;
    std::vector<Complex> p {unit * Complex(-15, 55), unit * Complex(-700, 0), unit * Complex(-60, 900)};
    std::vector<Complex> r {{3, 20}, {900, 0}, {20, 15}};
    if (rate > 0.0)
        for (std::size_t k = 0; k < p.size(); ++k) {
            p[k] = std::exp(p[k] / rate);
            r[k] /= rate;
        }
    m.truth = known(p, r, 0.5, rate, normal);
    m.data.value.resize(300, 1);
    m.data.deviation.resize(300, 1);
    for (int k = 0; k < 300; ++k) {
        const double f = 10.0 * std::pow(200.0, k / 299.0);
        m.data.frequency.push_back(f);
        const auto g = m.truth.at(pointOf(f, rate));
        m.data.deviation(k, 0) = 0.03 * std::abs(g);
        m.data.value(k, 0) = g + m.data.deviation(k, 0) * Complex(normal(), normal()) / std::numbers::sqrt2;
    }
    m.clean = m.data;
    for (int k = 0; k < 300; ++k)
        m.clean.value(k, 0) = m.truth.at(pointOf(m.data.frequency[static_cast<std::size_t>(k)], rate));
    IdentifyOptions options;
    options.order = 9;
    options.sampleRate = rate;
    options.refinement.stable = false;
    options.thorough = false;
    m.free = identify(m.data, options);
    return m;
}

}  // namespace

TEST_CASE("An unstable fit of a stable system is stabilized, and the constrained refit takes back what that cost")
{
    int unstable = 0;
    for (const double rate : {0.0, 16000.0})
        for (std::uint64_t seed = 1; seed <= 6; ++seed) {
            const auto m = measured(rate, seed);
            if (m.free.stable)
                continue;
            ++unstable;
            for (const auto method : {StabilizingMethod::mirror, StabilizingMethod::project}) {
                StabilizeOptions options;
                options.method = method;
                const auto found = stabilized(m.free.model, m.data, options);
                REQUIRE(found.steps.size() == 3);
                CHECK_FALSE(found.steps[0].stable);
                CHECK(found.steps[1].stable);
                CHECK(found.steps[2].stable);
                CHECK(isStable(found.model));
                INFO("rate " << rate << " seed " << seed << ": " << found.steps[0].weightedErrorDb << ", "
                             << found.steps[1].weightedErrorDb << ", " << found.steps[2].weightedErrorDb
                             << " dB, to the truth " << judged(found.model, m.clean).errorDb << " dB");
                CHECK(found.steps[2].weightedErrorDb <= found.steps[1].weightedErrorDb);
                CHECK(found.steps[0].errorDb == Approx(judged(m.free.model, m.data).errorDb));
                CHECK(found.steps[2].errorDb == Approx(judged(found.model, m.data).errorDb));
                // The noise is at -30.5 dB; the truth of order 5 is among what can be fitted.
                CHECK(found.steps[2].weightedErrorDb < -30.0);
                CHECK(judged(found.model, m.clean).errorDb < -36.0);
            }
        }
    CHECK(unstable >= 4);
}

TEST_CASE("A stable model is left alone, and what cannot be stabilized is refused in a sentence")
{
    Normal normal(9);
    const auto truth = known({{-3, 40}}, {{2, 5}}, 0.7, 0.0, normal);
    const auto found = stabilized(truth.model, sampled(truth.model));
    CHECK(found.steps.size() == 1);
    CHECK(found.reason == "the model is stable already");
    CHECK(found.model.A == truth.model.A);
    const auto mix = mixed(0.0, normal);
    StabilizeOptions parting;
    parting.method = StabilizingMethod::decompose;
    const auto parted = stabilized(mix.model, sampled(mix.model), parting);
    REQUIRE(parted.parts);
    CHECK(parted.model.order() == 5);
    CHECK(parted.parts->unstable.order() == 3);
    CHECK(parted.steps[0].errorDb < -200.0);  // the response is the model's own
    CHECK(parted.steps[1].errorDb > -40.0);
    auto data = sampled(mix.model, 50);
    CHECK(data.lines() == 50);
    CHECK(std::abs(data.value(7, 0) - mix.at(pointOf(data.frequency[7], 0.0))) < 1e-12 * std::abs(data.value(7, 0)));
    data.outputs = 2;
    data.value.conservativeResize(50, 2);
    data.value.col(1) = data.value.col(0);
    refused(Error::Kind::usage, "not one of", [&] { stabilized(mix.model, data); });
    StabilizeOptions options;
    options.refinement.maximumIterations = 0;
    refused(Error::Kind::usage, "iteration", [&] { stabilized(mix.model, sampled(mix.model), options); });
}
