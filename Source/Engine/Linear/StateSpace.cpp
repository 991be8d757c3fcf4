// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/StateSpace.h"

#include "Engine/Error.h"
#include "Engine/Numerics/Eigenvalues.h"
#include "Engine/Numerics/LuFactors.h"
#include "Engine/Validity.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {
namespace {

using Complex = std::complex<double>;

std::vector<Complex> sorted(std::vector<Complex> values)
{
    std::sort(values.begin(), values.end(), [](Complex a, Complex b) {
        if (std::abs(a.imag()) != std::abs(b.imag()))
            return std::abs(a.imag()) < std::abs(b.imag());
        return a.real() != b.real() ? a.real() < b.real() : a.imag() < b.imag();
    });
    return values;
}

std::string shape(const Eigen::MatrixXd& M) { return std::to_string(M.rows()) + " x " + std::to_string(M.cols()); }

}  // namespace

bool StateSpace::isValid(std::string* reason) const
{
    if (D.rows() < 1 || D.cols() < 1)
        return refuse(reason, "a state-space model needs an input and an output, but its D is " + shape(D));
    if (A.rows() != A.cols())
        return refuse(reason, "the A of a state-space model must be square, but is " + shape(A));
    if (B.rows() != A.rows() || B.cols() != D.cols())
        return refuse(reason, "the B of a state-space model with A " + shape(A) + " and D " + shape(D) + " cannot be "
                                  + shape(B));
    if (C.rows() != D.rows() || C.cols() != A.cols())
        return refuse(reason, "the C of a state-space model with A " + shape(A) + " and D " + shape(D) + " cannot be "
                                  + shape(C));
    if (!A.allFinite() || !B.allFinite() || !C.allFinite() || !D.allFinite())
        return refuse(reason, "a number of the state-space model is not finite");
    if (!(sampleRate >= 0.0) || !std::isfinite(sampleRate))
        return refuse(reason, "the sample rate of a state-space model must be 0 (continuous time) or above");
    return true;
}

std::vector<Complex> poles(const StateSpace& model)
{
    if (model.order() == 0)
        return {};
    const auto values = eigenvalues(model.A);
    return sorted({values.begin(), values.end()});
}

std::vector<Complex> zeros(const StateSpace& model)
{
    if (model.inputs() != model.outputs())
        throw Error(Error::Kind::usage, "Zeros are computed of models with as many inputs as outputs; this one has "
                                            + std::to_string(model.inputs()) + " and " + std::to_string(model.outputs())
                                            + ".");
    const auto n = model.order(), m = model.inputs();
    if (n == 0)
        return {};
    // Where D can be inverted the zeros are the poles of the inverse; the pencil serves where it cannot, or badly.
    Eigen::MatrixXd M(n + m, n + m), N = Eigen::MatrixXd::Zero(n + m, n + m);
    const double b = std::max(model.B.norm(), 1e-300), c = std::max(model.C.norm(), 1e-300);
    const double a = std::max(model.A.norm(), 1e-300);
    M << model.A, model.B * (a / b), model.C * (a / c), model.D * (a / b) * (a / c);
    N.topLeftCorner(n, n).setIdentity();
    const Eigen::GeneralizedEigenSolver<Eigen::MatrixXd> solver(M, N, false);
    std::vector<Complex> values;
    for (Eigen::Index k = 0; k < n + m; ++k) {
        const Complex alpha = solver.alphas()[k];
        const double beta = solver.betas()[k];
        // Where both vanish there is no zero, but a quotient of roundings.
        if (std::abs(beta) > 1e-14 && std::abs(alpha) <= 1e8 * a * std::abs(beta))
            values.push_back(alpha / beta);
    }
    return sorted(std::move(values));
}

double stabilityMargin(const StateSpace& model)
{
    double margin = std::numeric_limits<double>::infinity();
    for (const auto& pole : poles(model))
        margin = std::min(margin, model.continuous() ? -pole.real() : 1.0 - std::abs(pole));
    return margin;
}

bool isStable(const StateSpace& model) { return stabilityMargin(model) > 0.0; }

StateSpace transformed(const StateSpace& model, const Eigen::MatrixXd& T)
{
    const RealLu lu(T);
    StateSpace result = model;
    result.A = lu.solve(model.A * T);
    result.B = lu.solve(model.B);
    result.C = model.C * T;
    return result;
}

}  // namespace excursion
