// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Fractional/FractionalIntegrator.h"

#include "Engine/Error.h"

#include <cmath>

namespace excursion {
namespace {

using Eigen::Index;

constexpr double forgotten = 40.0;  // exp(-40) is below rounding

/// int_0^1 exp(-x (1 - s)) s^m ds, m = 0 .. 3.
Eigen::Vector4d moments(double x)
{
    Eigen::Vector4d I;
    if (x > 2.0) {
        I[0] = -std::expm1(-x) / x;
        for (int m = 1; m < 4; ++m)
            I[m] = (1.0 - m * I[m - 1]) / x;
        return I;
    }
    // sum_k (-x)^k m!/(k + m + 1)!: the recursion above would cancel
    for (int m = 0; m < 4; ++m) {
        double term = 1.0 / (m + 1.0);
        I[m] = 0.0;
        for (int k = 0; k < 30; ++k) {
            I[m] += term;
            term *= -x / (k + m + 2.0);
        }
    }
    return I;
}

/// The weights of v(n) .. v(n-3): the Lagrange polynomials of the nodes 1, 0, -1, -2, integrated.
Eigen::RowVector4d weights(double rate, double step)
{
    const auto I = moments(rate * step);
    return step
           * Eigen::RowVector4d((I[3] + 3.0 * I[2] + 2.0 * I[1]) / 6.0, -(I[3] + 2.0 * I[2] - I[1] - 2.0 * I[0]) / 2.0,
                                (I[3] + I[2] - 2.0 * I[1]) / 2.0, -(I[3] - I[1]) / 6.0);
}

}  // namespace

std::complex<double> FractionalIntegrator::response(std::complex<double> z) const
{
    const auto back = 1.0 / z;
    const Eigen::Vector4cd powers(1.0, back, back * back, back * back * back);
    std::complex<double> sum = (direct.cast<std::complex<double>>().array() * powers.array()).sum();
    for (Index k = 0; k < cells(); ++k)  // what the cell holds from before, one step later
        sum += readout[k] * decay[k] * back * (weight.row(k).cast<std::complex<double>>() * powers).value()
               / (1.0 - decay[k] * back);
    return sum;
}

FractionalIntegrator integratorFor(double alpha, double step, const DiffusiveLadderOptions& band)
{
    if (!(alpha > 0.0 && alpha <= 1.0) || !(step > 0.0))
        throw Error(Error::Kind::usage,
                    "A fractional integral needs an order above 0 and at most 1, and a step above 0 s.");
    DiffusiveLadder ladder;
    if (alpha == 1.0) {
        ladder.rates = Eigen::VectorXd::Zero(1);
        ladder.resistances = Eigen::VectorXd::Ones(1);
    } else {
        // s^-alpha = s^(a - 1), a = 1 - alpha; its R/s is a cell of rate 0
        const auto power = ladderFor(1.0 - alpha, band);
        ladder.inductance = power.inductance;
        ladder.rates.resize(power.cells() + 1);
        ladder.resistances.resize(power.cells() + 1);
        ladder.rates << 0.0, power.rates;
        ladder.resistances << power.resistance, power.resistances;
    }
    // The last cell matches the tail and moves with alpha: it is kept only where the one before it is.
    Index kept = 0;
    while (kept < ladder.cells()
           && ladder.rates[kept + (kept + 1 == ladder.cells() && kept > 0 ? -1 : 0)] * step <= forgotten)
        ++kept;
    FractionalIntegrator integrator;
    integrator.decay = (-step * ladder.rates.head(kept)).array().exp();
    integrator.readout = ladder.resistances.head(kept);
    integrator.weight.resize(kept, 4);
    integrator.direct[0] = ladder.inductance;
    for (Index k = 0; k < ladder.cells(); ++k) {
        const auto b = weights(ladder.rates[k], step);
        if (k < kept)
            integrator.weight.row(k) = b;
        integrator.direct += ladder.resistances[k] * b.transpose();
    }
    return integrator;
}

FractionalIntegrator integratorSlope(double alpha, double step, const DiffusiveLadderOptions& band)
{
    const double h = 1e-5 * std::min(alpha, 1.0 - alpha);
    if (!(h > 0.0))
        throw Error(Error::Kind::usage, "Only an order between 0 and 1 has a slope on both sides.");
    const auto above = integratorFor(alpha + h, step, band), below = integratorFor(alpha - h, step, band);
    return {(above.decay - below.decay) / (2.0 * h), (above.weight - below.weight) / (2.0 * h),
            (above.readout - below.readout) / (2.0 * h), (above.direct - below.direct) / (2.0 * h)};
}

}  // namespace excursion
