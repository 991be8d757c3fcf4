// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Fractional/MittagLeffler.h"

#include "Engine/Error.h"
#include "Engine/Fractional/Gamma.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace excursion {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

constexpr double nepers = 41.0;  // e^-41 = 1.6e-18: what truncation and step may leave of the largest integrand
// the series is taken for |z| up to the one, or |z|^(1/alpha) up to the other
constexpr double seriesRadius = 0.9, poleRadius = 1.5;

Complex series(double alpha, double beta, Complex z)
{
    Complex sum = 0.0, power = 1.0;
    for (int k = 0, small = 0; k < 4000 && small < 4; ++k, power *= z) {
        const Complex term = power * reciprocalGamma(alpha * k + beta);
        sum += term;
        // before, 1/Gamma has zeros
        small = alpha * k + beta > 1.0 && std::abs(term) <= 1e-18 * std::abs(sum) ? small + 1 : 0;
    }
    return sum;
}

/// The parabola's scale mu, the step h, and how far u runs.
struct Parabola {
    double mu, h, reach;
};

/// The rule errs by exp(-2 pi/h) for the branch point at u = j, near which the integrand grows like a power -p of the
/// distance, by exp(2 pi/h - pi^2/(h^2 mu)) for the growth of e^s on the other side, and by the tails left off.
Parabola parabolaFor(double alpha, double beta)
{
    // the saddle of e^s s^(alpha - beta): no cancellation between nodes
    const double mu = std::max(1.0, beta - alpha);
    const double p = std::max(1.0, 2.0 * beta);
    double x = nepers;  // pi/h
    for (int k = 0; k < 8; ++k)
        x = 0.5 * (nepers + p * (1.0 + std::log(std::max(2.0 * x / p, 1.0))));
    x = std::max(x, mu * (1.0 + std::sqrt(1.0 + nepers / mu)));
    const double q = std::max(0.0, alpha - beta) + 1.0;
    double square = 1.0;
    for (int k = 0; k < 8; ++k)
        square = 1.0 + (nepers + q * std::log1p(square)) / mu;
    return {mu, pi / x, std::sqrt(square)};
}

/// A pole on the sheet |arg s| < pi of s^alpha: where, and its residue.
struct Pole {
    Complex u, residue;
};

std::vector<Pole> polesOf(double alpha, double beta, Complex z, double mu)
{
    std::vector<Pole> poles;
    const double size = std::log(std::abs(z)) / alpha, angle = std::arg(z);
    for (int k = static_cast<int>(std::ceil(-0.5 * alpha - 0.5 * angle / pi)); angle + 2.0 * pi * k <= alpha * pi;
         ++k) {
        const Complex logarithm(size, (angle + 2.0 * pi * k) / alpha);
        if (size > 700.0 && std::cos(logarithm.imag()) <= 0.0)
            continue;
        // Not exp(logarithm), which loses a few digits more.
        const Complex s = std::polar(std::pow(std::abs(z), 1.0 / alpha), logarithm.imag()),
                      exponent = s + (1.0 - beta) * logarithm;
        Pole pole;
        pole.u = Complex(0.0, 1.0) * (1.0 - std::exp(0.5 * logarithm) / std::sqrt(mu));
        if (std::abs(s.real()) < 600.0)  // two factors lose fewer digits than the exponential of a sum
            pole.residue = std::exp(s) * std::exp((1.0 - beta) * logarithm) / alpha;
        else if (s.imag() == 0.0 && exponent.real() > 709.0 + std::log(alpha))
            pole.residue = std::numeric_limits<double>::infinity();
        else
            pole.residue = std::exp(exponent) / alpha;
        poles.push_back(pole);
    }
    return poles;
}

/// The shift of the nodes, in steps, that leaves the most room between them and the poles.
double shiftFor(const std::vector<Pole>& poles, double h)
{
    double best = -1.0, shift = 0.0;
    for (int k = 0; k < 8; ++k) {
        const double tau = 0.125 * k;
        double room = 0.5;
        for (const auto& pole : poles) {
            const double x = pole.u.real() / h - tau;
            room = std::min(room, std::hypot(x - std::nearbyint(x), pole.u.imag() / h));
        }
        if (room > best + 1e-9) {
            best = room;
            shift = tau;
        }
    }
    return shift;
}

Complex inverted(double alpha, double beta, Complex z)
{
    const auto path = parabolaFor(alpha, beta);
    const auto poles = polesOf(alpha, beta, z, path.mu);
    const double tau = shiftFor(poles, path.h);
    const int count = static_cast<int>(std::ceil(path.reach / path.h)) + 1;
    const double logMu = std::log(path.mu);
    Complex sum = 0.0;
    for (int k = -count; k <= count; ++k) {
        const Complex root(1.0, (k + tau) * path.h);  // s = mu root^2, ds = 2 j mu root du
        const Complex logS = logMu + 2.0 * std::log(root), s = path.mu * root * root;
        sum += std::exp(s + (alpha - beta) * logS) / (std::exp(alpha * logS) - z) * root;
    }
    Complex result = sum * (path.h * path.mu / pi);
    for (const auto& pole : poles) {
        const Complex exponent = Complex(0.0, -2.0 * pi) * (pole.u / path.h - tau);
        if (exponent.real() < -60.0)
            result += pole.residue;
        else if (exponent.real() < 700.0)
            result += pole.residue / (1.0 - std::exp(exponent));
    }
    return result;
}

}  // namespace

Complex mittagLeffler(double alpha, double beta, Complex z)
{
    if (!(alpha >= 0.05 && alpha <= 3.0 && beta >= -3.5 && beta <= 12.0 && std::isfinite(z.real())
          && std::isfinite(z.imag())))
        throw Error(
            Error::Kind::usage,
            "The Mittag-Leffler function is computed for alpha of 0.05 to 3, beta of -3.5 to 12 and finite arguments.");
    if (std::abs(z) <= std::max(seriesRadius, std::pow(poleRadius, alpha)))
        return series(alpha, beta, z);
    // Here the tail is no more than its rounding in the integral: E_{1,1-n}(z) = z^n e^z.
    if (alpha == 1.0 && beta <= 1.0 && beta == std::nearbyint(beta))
        return std::pow(z, static_cast<int>(1.0 - beta)) * std::exp(z);
    // E_{alpha,beta} = (E_{alpha,beta-alpha} - 1/Gamma(beta - alpha))/z: where the tail's first term vanishes, the next
    // one leads.
    if (const double first = reciprocalGamma(beta - alpha); std::abs(first) < 0.1)
        return (inverted(alpha, beta - alpha, z) - first) / z;
    return inverted(alpha, beta, z);
}

double mittagLeffler(double alpha, double beta, double z) { return mittagLeffler(alpha, beta, Complex(z, 0.0)).real(); }

}  // namespace excursion
