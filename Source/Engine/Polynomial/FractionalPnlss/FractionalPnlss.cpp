// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/FractionalPnlss/FractionalPnlss.h"

#include "Engine/Error.h"
#include "Engine/Numerics/LuFactors.h"
#include "Engine/Signal/Level.h"
#include "Engine/Validity.h"

#include <cmath>
#include <numbers>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

void requireValid(const FractionalPnlss& model)
{
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, "The fractional model is not valid: " + reason + ".");
}

/// C (diag(operators) - A)^-1 B + D, an operator a state.
Eigen::MatrixXcd responseAt(const StateSpace& linear, const Eigen::VectorXcd& operators)
{
    Eigen::MatrixXcd M = -linear.A.cast<Complex>();
    M.diagonal() += operators;
    return linear.C.cast<Complex>() * ComplexLu(M).solve(linear.B.cast<Complex>()) + linear.D.cast<Complex>();
}

FractionalGrid gridOf(double sampleRate, int substeps, double seconds)
{
    const double nyquist = 0.5 * sampleRate * substeps;
    return {sampleRate, substeps, {std::min(0.25 / seconds, 0.01 * nyquist), nyquist, 3.0}};
}

}  // namespace

bool FractionalPnlss::isValid(std::string* reason) const
{
    if (!form.fits(reason))
        return false;
    if (!form.linear.continuous())
        return refuse(reason, "a model of fractional order is one of continuous time, but has a sample rate");
    if (fractional.size() != form.linear.order())
        return refuse(reason, "every state must be told to be of fractional order, or not");
    if (fractional.any() && !(alpha > 0.0 && alpha < 1.0))
        return refuse(reason, "the order alpha must lie between 0 and 1");
    return true;
}

FractionalPnlss withTerms(const StateSpace& form, double alpha, const Eigen::Array<bool, Eigen::Dynamic, 1>& fractional,
                          int degree, TermMask mask, bool offset)
{
    auto discrete = form;  // withTerms() of Pnlss knows no other
    discrete.sampleRate = 1.0;
    FractionalPnlss model {alpha, fractional, withTerms(discrete, degree, mask, offset)};
    model.form.linear.sampleRate = 0.0;
    requireValid(model);
    return model;
}

FractionalPnlss withTerms(const FractionalStateSpace& linear, int degree, TermMask mask, bool offset)
{
    return withTerms(linear.form, linear.alpha,
                     Eigen::Array<bool, Eigen::Dynamic, 1>::Constant(linear.form.order(), linear.alpha != 1.0), degree,
                     mask, offset);
}

std::vector<Eigen::MatrixXcd> respondLinear(const FractionalPnlss& model, const std::vector<double>& frequency)
{
    requireValid(model);
    std::vector<Eigen::MatrixXcd> responses;
    Eigen::VectorXcd operators(model.form.linear.order());
    for (const double f : frequency) {
        const Complex s(0.0, 2.0 * std::numbers::pi * f);
        for (Index i = 0; i < operators.size(); ++i)
            operators[i] = model.fractional[i] ? std::pow(s, model.alpha) : s;
        responses.push_back(responseAt(model.form.linear, operators));
    }
    return responses;
}

std::vector<FractionalIntegrator> integratorsOf(const Eigen::Array<bool, Eigen::Dynamic, 1>& fractional, double alpha,
                                                const FractionalGrid& grid)
{
    const auto whole = integratorFor(1.0, grid.step(), grid.band);
    const auto part = fractional.any() ? integratorFor(alpha, grid.step(), grid.band) : whole;
    std::vector<FractionalIntegrator> result;
    for (Index i = 0; i < fractional.size(); ++i)
        result.push_back(fractional[i] ? part : whole);
    return result;
}

GridError errorOf(const FractionalPnlss& model, const FractionalGrid& grid, const std::vector<double>& frequency)
{
    const auto exact = respondLinear(model, frequency);
    const auto integrators = integratorsOf(model.fractional, model.alpha, grid);
    double error = 0.0, power = 0.0;
    Eigen::VectorXcd operators(model.form.linear.order());
    for (std::size_t k = 0; k < frequency.size(); ++k) {
        const auto z = std::polar(1.0, 2.0 * std::numbers::pi * frequency[k] * grid.step());
        for (Index i = 0; i < operators.size(); ++i)
            operators[i] = 1.0 / integrators[static_cast<std::size_t>(i)].response(z);
        error += (responseAt(model.form.linear, operators) - exact[k]).squaredNorm();
        power += exact[k].squaredNorm();
    }
    return {decibelsOf(error / power), isStable(model, grid)};
}

FractionalGrid gridFor(const FractionalPnlss& model, double sampleRate, const std::vector<double>& frequency,
                       double seconds, double tolerance)
{
    requireValid(model);
    if (!(sampleRate > 0.0) || !(seconds > 0.0) || !(tolerance > 0.0))
        throw Error(Error::Kind::usage, "A grid needs a sample rate, a length and a tolerance above 0.");
    constexpr int finest = 16;
    for (int substeps = 1; substeps < finest; ++substeps) {
        const auto grid = gridOf(sampleRate, substeps, seconds);
        const auto reached = errorOf(model, grid, frequency);
        if (reached.stable && reached.errorDb <= decibelsOf(tolerance * tolerance))
            return grid;
    }
    return gridOf(sampleRate, finest, seconds);
}

StateSpace expandedLinear(const FractionalPnlss& model, const FractionalGrid& grid)
{
    requireValid(model);
    const auto& linear = model.form.linear;
    const auto n = linear.order();
    const auto integrators = integratorsOf(model.fractional, model.alpha, grid);
    Index cells = 0;
    for (const auto& integrator : integrators)
        cells += integrator.cells();
    const Index size = cells + 3 * n;  // cells, then v(t-1), v(t-2), v(t-3)
    MatrixXd held = MatrixXd::Zero(n, size), own = MatrixXd::Zero(size, size), ofNew = MatrixXd::Zero(size, n);
    Eigen::VectorXd gain(n);
    Index at = 0;
    for (Index i = 0; i < n; ++i) {
        const auto& f = integrators[static_cast<std::size_t>(i)];
        const auto K = f.cells();
        gain[i] = f.direct[0];
        held.row(i).segment(at, K) = (f.readout.array() * f.decay.array()).matrix().transpose();
        own.block(at, at, K, K).diagonal() = f.decay;
        ofNew.block(at, i, K, 1) = f.weight.col(0);
        for (Index j = 0; j < 3; ++j) {
            held(i, cells + j * n + i) = f.direct[j + 1];
            own.block(at, cells + j * n + i, K, 1) = f.weight.col(j + 1);
        }
        at += K;
    }
    ofNew.block(cells, 0, n, n).setIdentity();
    own.block(cells + n, cells, 2 * n, 2 * n).setIdentity();
    const RealLu solver(MatrixXd::Identity(n, n) - gain.asDiagonal() * linear.A);
    const MatrixXd zetaOfPast = solver.solve(held), zetaOfInput = solver.solve(gain.asDiagonal() * linear.B);
    StateSpace expanded;
    expanded.sampleRate = grid.sampleRate * grid.substeps;
    expanded.A = own + ofNew * linear.A * zetaOfPast;
    expanded.B = ofNew * (linear.A * zetaOfInput + linear.B);
    expanded.C = linear.C * zetaOfPast;
    expanded.D = linear.C * zetaOfInput + linear.D;
    return expanded;
}

bool isStable(const FractionalPnlss& model, const FractionalGrid& grid)
{
    return stabilityMargin(expandedLinear(model, grid)) > -1e-9;
}

}  // namespace excursion
