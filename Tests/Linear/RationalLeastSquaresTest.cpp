// SPDX-License-Identifier: GPL-3.0-or-later
// The classical fits of a quotient of polynomials, beside the maximum likelihood that replaces them.
#include "Engine/Linear/Identify.h"
#include "Engine/Linear/RationalLeastSquares.h"
#include "Engine/Linear/Response.h"
#include "Linear/Problem.h"

#include <Eigen/QR>

#include <cmath>
#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Complex = std::complex<double>;

namespace {

/// Resonances at 50 Hz and 900 Hz and a real pole: order 5.
Complex fiveAt(double f)
{
    const Complex s(0.0, 2.0 * std::numbers::pi * f);
    const Complex a(-40.0, 310.0), b(-300.0, 5600.0);
    return 0.2 + 100.0 / (s - a) + 100.0 / (s - std::conj(a)) + Complex(30.0, 100.0) / (s - b)
           + Complex(30.0, -100.0) / (s - std::conj(b)) + 2000.0 / (s + 9000.0);
}

FrequencyData fiveMeasured(double noise, std::uint64_t seed)
{
    Normal normal(seed);
    FrequencyData data;
    data.value.resize(250, 1);
    for (int k = 0; k < 250; ++k) {
        data.frequency.push_back(10.0 * std::pow(300.0, k / 249.0));
        data.value(k, 0) = fiveAt(data.frequency.back());
        data.value(k, 0) += noise * Complex(normal(), normal()) / std::numbers::sqrt2;
    }
    if (noise > 0.0)
        data.deviation = Eigen::MatrixXd::Constant(250, 1, noise);
    return data;
}

}  // namespace

TEST_CASE("Exact data is met by Levy at once, poles and all")
{
    RationalOptions options;
    options.order = 5;
    const auto found = fitRational(fiveMeasured(0.0, 1), options);
    // -234 dB: the resonance lies 60 times below the end of the band
    CHECK(10.0 * std::log10(found.fit.cost) < -230.0);
    CHECK(found.converged());
    const auto p = poles(found.fit.sections);
    for (const Complex expected : {Complex(-40, 310), Complex(-300, 5600), Complex(-9000, 0)}) {
        double nearest = 1e9;
        for (const auto& q : p)
            nearest = std::min(nearest, std::abs(q - expected));
        CHECK(nearest < 1e-7 * std::abs(expected));
    }
    const auto model = realize(found.fit.sections, found.fit.C, found.fit.D);
    CHECK(std::abs(respond(model, {123.0})[0](0, 0) - fiveAt(123.0)) < 1e-10 * std::abs(fiveAt(123.0)));
}

TEST_CASE("Levy solves the equations that it is known by")
{
    // Of order 1, G (s + d) = n1 s + n0 in real and imaginary parts, in plain powers of s / 1000 and with Eigen's own
    // least squares.
    const auto data = fiveMeasured(0.0, 1);
    Eigen::MatrixXd M(500, 3);
    Eigen::VectorXd right(500);
    for (int k = 0; k < 250; ++k) {
        const Complex s(0.0, 2.0 * std::numbers::pi * data.frequency[static_cast<std::size_t>(k)] / 1000.0),
            g = data.value(k, 0);
        const Complex row[] {s, 1.0, -g};
        for (int c = 0; c < 3; ++c) {
            M(k, c) = row[c].real();
            M(250 + k, c) = row[c].imag();
        }
        right[k] = (g * s).real();
        right[250 + k] = (g * s).imag();
    }
    const Eigen::VectorXd x = M.colPivHouseholderQr().solve(right);
    RationalOptions options;
    options.order = 1;
    const auto found = fitRational(data, options);
    CHECK(poles(found.fit.sections)[0].real() == Approx(-1000.0 * x[2]).epsilon(1e-9));
    CHECK(found.fit.D[0] == Approx(x[0]).epsilon(1e-9));
}

TEST_CASE("With noise iterating helps Levy, and maximum likelihood both")
{
    double levy = 0.0, iterated = 0.0, likely = 0.0;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        const auto data = fiveMeasured(0.01, seed);
        RationalOptions options;
        options.order = 5;
        const auto first = fitRational(data, options);
        options.iterations = 60;
        const auto last = fitRational(data, options);
        IdentifyOptions best;
        best.order = 5;
        const auto fit = identify(data, best);
        CHECK(fit.cost <= last.fit.cost * (1.0 + 1e-9));
        CHECK(last.fit.cost < first.fit.cost);
        levy += first.fit.cost / 8.0;
        iterated += last.fit.cost / 8.0;
        likely += fit.cost / 8.0;
    }
    INFO("Levy " << 10.0 * std::log10(levy) << " dB, Sanathanan-Koerner " << 10.0 * std::log10(iterated)
                 << " dB, maximum likelihood " << 10.0 * std::log10(likely) << " dB");
    CHECK(iterated < 0.5 * levy);
    RationalOptions options;
    options.order = 0;
    refused(Error::Kind::usage, "order", [&] { fitRational(fiveMeasured(0.0, 1), options); });
    options.order = 300;
    refused(Error::Kind::data, "lines", [&] { fitRational(fiveMeasured(0.0, 1), options); });
}
