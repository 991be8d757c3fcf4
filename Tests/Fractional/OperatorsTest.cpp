// SPDX-License-Identifier: GPL-3.0-or-later
// Fractional integrals and derivatives of monomials against D^alpha t^p = Gamma(p + 1)/Gamma(p + 1 - alpha) t^(p -
// alpha).
#include "Engine/Fractional/Operators.h"
#include "Scratch.h"

#include <cmath>
#include <functional>

using namespace excursion;
using namespace excursion::test;

namespace {

using Operator = std::function<std::vector<double>(const std::vector<double>&, double)>;

/// The largest error over the latter half of 0 .. 2 s, relative to the value at the end.
double errorOf(const Operator& apply, double p, double alpha, int samples)
{
    const double T = 2.0 / (samples - 1);
    std::vector<double> f;
    for (int n = 0; n < samples; ++n)
        f.push_back(std::pow(n * T, p));
    const auto found = apply(f, T);
    const auto truth = [&](double t) {
        return std::tgamma(p + 1.0) / std::tgamma(p + 1.0 - alpha) * std::pow(t, p - alpha);
    };
    double worst = 0.0;
    for (int n = samples / 2; n < samples; ++n)
        worst = std::max(worst, std::abs(found[static_cast<std::size_t>(n)] - truth(n * T)));
    return worst / truth(2.0);
}

/// The order of convergence between two steps.
double orderOf(const Operator& apply, double p, double alpha)
{
    return std::log2(errorOf(apply, p, alpha, 1001) / errorOf(apply, p, alpha, 2001));
}

}  // namespace

TEST_CASE("The weights of Gruenwald and Letnikov are binomial coefficients")
{
    const auto third = gruenwaldWeights(3.0, 6);  // 1 -3 3 -1 0 0
    for (std::size_t j = 0; j < 6; ++j)
        CHECK(third[j] == std::vector<double> {1, -3, 3, -1, 0, 0}[j]);
    const auto sum = gruenwaldWeights(-1.0, 6);
    for (const double w : sum)
        CHECK(w == 1.0);
    const auto half = gruenwaldWeights(0.5, 5);  // 1 - x/2 - x^2/8 - x^3/16 - 5 x^4/128
    CHECK(half[4] == Approx(-5.0 / 128.0).epsilon(1e-15));
}

TEST_CASE("Gruenwald and Letnikov's difference converges with order 1")
{
    for (const double alpha : {-1.4, -0.5, 0.3, 0.5, 0.8, 1.6}) {
        const Operator apply = [alpha](const auto& f, double T) { return gruenwaldLetnikov(f, alpha, T); };
        INFO("alpha " << alpha);
        for (const double p : {1.0, 1.5, 3.0}) {
            if (p == 1.0 && alpha > 1.0)
                continue;  // t^(1 - alpha) is singular at 0
            CHECK(errorOf(apply, p, alpha, 2001) < 5e-3);
            CHECK(orderOf(apply, p, alpha) == Approx(1.0).margin(0.1));
        }
    }
}

TEST_CASE("The fractional integral is exact for lines and converges with order 2")
{
    for (const double alpha : {0.2, 0.5, 1.0, 1.7}) {
        const Operator apply = [alpha](const auto& f, double T) { return fractionalIntegral(f, alpha, T); };
        INFO("alpha " << alpha);
        CHECK(errorOf(apply, 0.0, -alpha, 1001) < 1e-12);
        CHECK(errorOf(apply, 1.0, -alpha, 1001) < 1e-12);
        CHECK(errorOf(apply, 2.0, -alpha, 2001) < 1e-6);
        CHECK(orderOf(apply, 2.0, -alpha) == Approx(2.0).margin(0.1));
    }
}

TEST_CASE("Caputo's and Riemann and Liouville's derivatives converge with order 2")
{
    for (const double alpha : {0.3, 0.5, 0.9, 1.0, 1.2, 1.5, 1.8}) {
        INFO("alpha " << alpha);
        for (const bool caputo : {true, false}) {
            const Operator apply = [=](const auto& f, double T) {
                return caputo ? caputoDerivative(f, alpha, T) : riemannLiouvilleDerivative(f, alpha, T);
            };
            CHECK(errorOf(apply, 4.0, alpha, 2001) < 1e-5);
            CHECK(orderOf(apply, 4.0, alpha) == Approx(2.0).margin(0.1));
        }
    }
    // They differ by what the start adds: of a constant Caputo's is 0, the other t^-alpha/Gamma(1 - alpha).
    const std::vector<double> constant(101, 3.0);
    const auto caputo = caputoDerivative(constant, 0.4, 0.01), other = riemannLiouvilleDerivative(constant, 0.4, 0.01);
    CHECK(std::abs(caputo[50]) < 1e-12);
    CHECK(other[50] == Approx(3.0 * std::pow(0.5, -0.4) / std::tgamma(0.6)).epsilon(1e-12));
    CHECK(std::isinf(other[0]));
    // Beyond order 1 the start slope adds t^(1 - alpha)/Gamma(2 - alpha).
    std::vector<double> line;
    for (int n = 0; n <= 100; ++n)
        line.push_back(3.0 + 2.0 * 0.01 * n);
    CHECK(std::abs(caputoDerivative(line, 1.3, 0.01)[80]) < 1e-9);
    CHECK(riemannLiouvilleDerivative(line, 1.3, 0.01)[80]
          == Approx(3.0 * std::pow(0.8, -1.3) / std::tgamma(-0.3) + 2.0 * std::pow(0.8, -0.3) / std::tgamma(0.7))
                 .epsilon(1e-9));
}

TEST_CASE("Two half integrals of a long record make a whole one")
{
    std::vector<double> f;
    for (int n = 0; n < 100000; ++n)
        f.push_back(std::sin(1e-3 * n));
    const auto twice = fractionalIntegral(fractionalIntegral(f, 0.5, 1e-3), 0.5, 1e-3);
    for (const std::size_t n : {1000u, 31416u, 99999u})
        CHECK(std::abs(twice[n] - (1.0 - std::cos(1e-3 * static_cast<double>(n)))) < 2e-5);
}

TEST_CASE("Fractional operators refuse what they cannot do")
{
    const std::vector<double> f(10, 1.0);
    refused(Error::Kind::usage, "integral", [&] { fractionalIntegral(f, 0.0, 0.1); });
    refused(Error::Kind::usage, "derivative", [&] { caputoDerivative(f, 2.5, 0.1); });
    refused(Error::Kind::usage, "interval", [&] { gruenwaldLetnikov(f, 0.5, 0.0); });
    refused(Error::Kind::data, "4 samples", [&] { caputoDerivative(std::vector<double>(3), 0.5, 0.1); });
}
