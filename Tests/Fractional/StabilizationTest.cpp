// SPDX-License-Identifier: GPL-3.0-or-later
// Stable models of fractional order, against responses that are written out here by partial fractions.
#include "Engine/Fractional/FractionalIdentify.h"
#include "Engine/Fractional/FractionalStabilization.h"
#include "Engine/Linear/Identify.h"
#include "Engine/Linear/PoleZero.h"
#include "Fractional/RandomRoots.h"
#include "Linear/Problem.h"

#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Complex = std::complex<double>;
using std::numbers::pi;

namespace {

/// D + sum of r/(lambda - p) and conjugates; the first `stable` of the poles lie outside of the sector.
struct Parts {
    double alpha = 0.5, direct = 0.3;
    std::vector<Complex> poles, residues;
    std::size_t stable = 0;

    Complex at(Complex lambda, std::size_t first, std::size_t last) const
    {
        Complex sum = 0.0;
        for (std::size_t k = first; k < last; ++k) {
            sum += residues[k] / (lambda - poles[k]);
            if (poles[k].imag() != 0.0)
                sum += std::conj(residues[k]) / (lambda - std::conj(poles[k]));
        }
        return sum;
    }

    FractionalStateSpace model(Normal& normal) const
    {
        Eigen::Index n = 0;
        for (const auto& pole : poles)
            n += pole.imag() != 0.0 ? 2 : 1;
        StateSpace form;
        form.A = Eigen::MatrixXd::Zero(n, n);
        form.B = Eigen::MatrixXd::Zero(n, 1);
        form.C = Eigen::MatrixXd::Zero(1, n);
        form.D = Eigen::MatrixXd::Constant(1, 1, direct);
        Eigen::Index at = 0;
        for (std::size_t k = 0; k < poles.size(); ++k) {
            const auto p = poles[k], r = residues[k];
            if (p.imag() == 0.0) {
                form.A(at, at) = p.real();
                form.B(at, 0) = r.real();
                form.C(0, at++) = 1.0;
                continue;
            }
            form.A.block(at, at, 2, 2) << p.real(), p.imag(), -p.imag(), p.real();
            form.B(at, 0) = 1.0;
            form.C.block(0, at, 1, 2) << 2.0 * r.real(), 2.0 * r.imag();
            at += 2;
        }
        Eigen::MatrixXd T(n, n);
        for (auto& x : T.reshaped())
            x = 0.3 * normal();
        T.diagonal().array() += 1.0;
        return {alpha, transformed(form, T)};
    }
};

Parts randomParts(double alpha, Normal& normal)
{
    Parts parts;
    parts.alpha = alpha;
    const double border = 0.5 * pi * alpha;
    for (int k = 0; k < 5; ++k) {
        const bool stable = k < 3;
        const double size = std::pow(10.0, drawn(normal, 0.5, 2.0));
        auto pole = std::polar(size, stable ? border + drawn(normal, 0.15, 0.9) * (pi - border)
                                            : drawn(normal, 0.1, 0.85) * border);
        if (k == 2)
            pole = -size;
        if (k == 4)
            pole = size;
        parts.poles.push_back(pole);
        parts.residues.push_back(pole.imag() == 0.0
                                     ? Complex(size, 0.0)
                                     : size * Complex(drawn(normal, -1.0, 1.0), drawn(normal, -1.0, 1.0)));
    }
    parts.stable = 3;
    return parts;
}

}  // namespace

TEST_CASE("A fractional model falls apart at the border of the sector, and the parts are those it was made of")
{
    Normal normal(13);
    for (const double alpha : {0.3, 0.5, 0.8, 1.0, 1.4})
        for (int trial = 0; trial < 4; ++trial) {
            const auto parts = randomParts(alpha, normal);
            const auto model = parts.model(normal);
            INFO("alpha " << alpha << ", trial " << trial);
            REQUIRE_FALSE(isStable(model));
            StabilizeOptions options;
            options.method = StabilizingMethod::decompose;
            const auto found = stabilized(model, sampled(model), options);
            REQUIRE(found.unstable);
            CHECK(found.model.form.order() == 5);
            CHECK(found.unstable->form.order() == 3);
            CHECK(found.sectorMargin > 0.0);
            CHECK(isStable(found.model));
            CHECK(found.steps.back().stable);
            for (const double f : {0.02, 0.7, 11.0, 400.0}) {
                const auto lambda = onRay(f, alpha);
                const auto size = std::abs(respond(model, {f})[0](0, 0)) + 1.0;
                CHECK(std::abs(respond(model, {f})[0](0, 0) - parts.direct - parts.at(lambda, 0, 5)) < 1e-9 * size);
                CHECK(std::abs(respond(found.model, {f})[0](0, 0) - parts.direct - parts.at(lambda, 0, 3))
                      < 1e-8 * size);
                CHECK(std::abs(respond(*found.unstable, {f})[0](0, 0) - parts.at(lambda, 3, 5)) < 1e-8 * size);
            }
        }
}

TEST_CASE("A pole that is reflected at the sector changes magnitudes as far as its conjugate moved")
{
    const double rho = 50.0, phi = 0.5, alpha = 0.5, theta = 0.25 * pi;
    PoleZeroGain g;
    g.gain = 4.0;
    addBoth(g.poles, std::polar(rho, phi));
    addBoth(g.poles, Complex(-20.0, 3.0));
    g.zeros = {-7.0};
    const FractionalStateSpace model {alpha, realize(g)};
    REQUIRE_FALSE(isStable(model));
    const FractionalStateSpace moved {alpha, mirroredAtSector(model.form, alpha)};
    CHECK(isStable(moved));
    for (const double r : {1.0, 20.0, 50.0, 200.0, 5000.0}) {
        const double f = r * r / (2.0 * pi);
        const double ratio = std::abs(respond(moved, {f})[0](0, 0) / respond(model, {f})[0](0, 0));
        const auto apart = [&](double angle) { return r * r + rho * rho - 2.0 * r * rho * std::cos(angle); };
        const double expected = apart(theta + phi) / apart(3.0 * theta - phi);
        CHECK(ratio == Approx(std::sqrt(expected)).epsilon(1e-7));
    }
}

TEST_CASE("Unstable fractional fits of stable systems are stabilized, and the refit takes back what that cost")
{
    int unstable = 0;
    for (const double alpha : {0.5, 0.8, 1.2})
        for (std::uint64_t seed = 1; seed <= 5; ++seed) {
            Normal normal(seed);
            const auto truth = [&](double f) {
                const auto l = onRay(f, alpha) / std::pow(2.0 * pi * 100.0, alpha);
                return 1.0 + 1.0 / (l * l + 1.4 * l + 1.0) + 2.0 / (l + 5.0);
            };
            FrequencyData data;
            data.value.resize(200, 1);
            for (int k = 0; k < 200; ++k) {
                data.frequency.push_back(5.0 * std::pow(1000.0, k / 199.0));
                data.value(k, 0) = truth(data.frequency.back());
            }
            auto clean = data;
            data.deviation = clean.deviation = 0.03 * data.value.cwiseAbs();
            for (Eigen::Index k = 0; k < 200; ++k)
                data.value(k, 0) += data.deviation(k, 0) * std::sqrt(0.5) * Complex(normal(), normal());
            FractionalOptions fitting;
            fitting.order = 8;
            fitting.alpha = alpha;
            fitting.thorough = false;
            fitting.refinement.stable = false;
            const auto free = identifyFractional(data, fitting);
            if (isStable(free.model))
                continue;
            ++unstable;
            for (const auto method : {StabilizingMethod::mirror, StabilizingMethod::project}) {
                StabilizeOptions options;
                options.method = method;
                const auto found = stabilized(free.model, data, options);
                INFO("alpha " << alpha << ", seed " << seed << ": " << found.steps[0].weightedErrorDb << ", "
                              << found.steps[1].weightedErrorDb << ", " << found.steps.back().weightedErrorDb << " dB");
                REQUIRE(found.steps.size() == 3);
                CHECK_FALSE(found.steps[0].stable);
                CHECK(found.steps[1].stable);
                CHECK(found.steps[2].stable);
                CHECK(isStable(found.model));
                CHECK(found.sectorMargin > 0.0);
                CHECK(found.steps[2].weightedErrorDb <= found.steps[1].weightedErrorDb);
                // The noise is at -30.5 dB; the truth of order 3 is among what can be fitted.
                CHECK(found.steps[2].weightedErrorDb < -30.0);
                CHECK(judged(found.model.form, clean, alpha).errorDb < -36.0);
            }
        }
    CHECK(unstable >= 10);
}

TEST_CASE("What cannot be stabilized at the sector is refused, and what is stable is left alone")
{
    Normal normal(2);
    auto parts = randomParts(0.5, normal);
    const auto bad = parts.model(normal);
    parts.poles.resize(3);
    const auto good = parts.model(normal);
    const auto kept = stabilized(good, sampled(good));
    CHECK(kept.steps.size() == 1);
    CHECK(kept.model.form.A == good.form.A);
    StabilizeOptions options;
    options.method = StabilizingMethod::delay;
    refused(Error::Kind::usage, "No delay", [&] { stabilized(bad, sampled(bad), options); });
    options.alpha = 0.5;
    refused(Error::Kind::usage, "order of differentiation", [&] { stabilized(bad.form, sampled(bad), options); });
    refused(Error::Kind::usage, "between 0 and 2", [&] {
        stabilized(FractionalStateSpace {2.0, bad.form}, sampled(bad));
    });
    refused(Error::Kind::usage, "between 0 and 2", [&] { decomposed(bad.form, -1.0); });
    auto several = bad;
    several.form.C = several.form.C.replicate(2, 1).eval();
    several.form.D = several.form.D.replicate(2, 1).eval();
    refused(Error::Kind::usage, "one input and one output", [&] { stabilized(several, sampled(several)); });
}
