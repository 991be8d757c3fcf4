// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Fractional/TimeResponse.h"

#include "Engine/Error.h"
#include "Engine/Fractional/MittagLeffler.h"
#include "Engine/Fractional/Operators.h"
#include "Engine/Linear/LinearHold.h"
#include "Engine/Linear/Simulation.h"
#include "Engine/Numerics/Eigenvalues.h"
#include "Engine/Numerics/LuFactors.h"

#include <cmath>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

void require(const FractionalStateSpace& model, const char* what)
{
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, std::string(what) + ": " + reason + ".");
}

void requireInput(const FractionalStateSpace& model, const MatrixXd& input, double sampleRate)
{
    require(model, "The model cannot be simulated");
    if (input.cols() != model.form.inputs())
        throw Error(Error::Kind::usage, "The model has " + std::to_string(model.form.inputs()) + " inputs, but "
                                            + std::to_string(input.cols()) + " were given.");
    if (!(sampleRate > 0.0))
        throw Error(Error::Kind::usage, "A simulation needs a sample rate above 0 Hz.");
}

/// C t^(beta-1) E_{alpha,beta}(A t^alpha) B at each time.
std::vector<MatrixXd> modalResponse(const FractionalStateSpace& model, const std::vector<double>& times, double beta)
{
    require(model, "The model has no response");
    const auto& form = model.form;
    const auto n = form.order();
    Eigen::VectorXcd values(n);
    MatrixXcd C(form.outputs(), n), B(n, form.inputs());
    if (n > 0) {
        // States scaled to balance rows and columns of A: eigenvectors of a chain of derivatives are badly scaled.
        Eigen::VectorXd scale = Eigen::VectorXd::Ones(n);
        MatrixXd A = form.A;
        for (int pass = 0; pass < 20; ++pass)
            for (Index i = 0; i < n; ++i) {
                const double row = A.row(i).cwiseAbs().sum() - std::abs(A(i, i)),
                             column = A.col(i).cwiseAbs().sum() - std::abs(A(i, i));
                if (!(row > 0.0 && column > 0.0))
                    continue;
                const double f = std::sqrt(row / column);
                scale[i] *= f;
                A.col(i) *= f;
                A.row(i) /= f;
            }
        const auto modes = eigenvectors(A);
        const ComplexLu lu(modes.vectors);
        if (!(lu.rcond() > 1e-10))
            throw Error(Error::Kind::numerical, "The response in time is computed from eigenvectors, but two of this "
                                                "model's are the same within rounding.");
        values = modes.values;
        C = (form.C * scale.asDiagonal()).cast<std::complex<double>>() * modes.vectors;
        B = lu.solve(MatrixXd(scale.cwiseInverse().asDiagonal() * form.B).cast<std::complex<double>>());
    }
    std::vector<MatrixXd> result;
    for (const double t : times) {
        if (!(t >= 0.0 && std::isfinite(t)))
            throw Error(Error::Kind::usage, "Responses are computed at times of at least 0 s.");
        Eigen::VectorXcd middle(n);
        const double power = std::pow(t, model.alpha), factor = std::pow(t, beta - 1.0);
        for (Index i = 0; i < n; ++i)
            middle[i] = factor * mittagLeffler(model.alpha, beta, values[i] * power);
        result.push_back((C * middle.asDiagonal() * B).real());
    }
    return result;
}

}  // namespace

std::vector<MatrixXd> stepResponse(const FractionalStateSpace& model, const std::vector<double>& times)
{
    auto result = modalResponse(model, times, model.alpha + 1.0);
    for (auto& y : result)
        y += model.form.D;
    return result;
}

std::vector<MatrixXd> impulseResponse(const FractionalStateSpace& model, const std::vector<double>& times)
{
    return modalResponse(model, times, model.alpha);
}

StateSpace expanded(const FractionalStateSpace& model, const DiffusiveLadderOptions& band)
{
    require(model, "The model has no ladder");
    const auto& form = model.form;
    if (model.alpha == 1.0)
        return form;
    const bool above = model.alpha > 1.0;
    const auto ladder = ladderFor(above ? 2.0 - model.alpha : 1.0 - model.alpha, band);
    const auto n = form.order(), cells = ladder.cells();
    const auto I = MatrixXd::Identity(n, n);

    // v is what is integrated: by the ladder itself, or by an integrator and then the ladder. States z_k, then w (of
    // R/s), then the integrator q. Below 1: x = M (sum R_k z_k + R w + L B u), M = (I - L A)^-1, v = A x + B u. Above:
    // x = sum R_k z_k + R w + L q, dq/dt = v.
    StateSpace result;
    const Index blocks = cells + (above ? 2 : 1), order = n * blocks;
    MatrixXd X = MatrixXd::Zero(n, order), direct = MatrixXd::Zero(n, form.inputs());
    for (Index k = 0; k < cells; ++k)
        X.middleCols(k * n, n) = ladder.resistances[k] * I;
    X.middleCols(cells * n, n) = ladder.resistance * I;
    if (above)
        X.rightCols(n) = ladder.inductance * I;
    else {
        const RealLu lu(I - ladder.inductance * form.A);
        if (n > 0 && !(lu.rcond() > 1e-14))
            throw Error(Error::Kind::numerical,
                        "The ladder's band ends at an eigenvalue of the model; take a wider one.");
        X = lu.solve(X).eval();
        direct = lu.solve(ladder.inductance * form.B);
    }
    const MatrixXd rate = form.A * X, drive = form.A * direct + form.B;  // v
    result.A = MatrixXd::Zero(order, order);
    result.B = MatrixXd::Zero(order, form.inputs());
    for (Index k = 0; k < blocks; ++k) {
        if (above && k + 1 < blocks)
            result.A.block(k * n, order - n, n, n) = I;
        else {
            result.A.middleRows(k * n, n) = rate;
            result.B.middleRows(k * n, n) = drive;
        }
        if (k < cells)
            result.A.block(k * n, k * n, n, n).diagonal().array() -= ladder.rates[k];
    }
    result.C = form.C * X;
    result.D = form.C * direct + form.D;
    return result;
}

MatrixXd simulateByLadder(const FractionalStateSpace& model, const MatrixXd& input, double sampleRate,
                          const DiffusiveLadderOptions& band)
{
    requireInput(model, input, sampleRate);
    if (input.rows() == 0)
        return MatrixXd(0, model.form.outputs());
    const auto hold = linearHold(expanded(model, band), sampleRate);
    return simulate(hold.model, input, hold.startOf(input.row(0).transpose()));
}

MatrixXd simulateByDifference(const FractionalStateSpace& model, const MatrixXd& input, double sampleRate)
{
    requireInput(model, input, sampleRate);
    const auto n = model.form.order(), N = input.rows();
    const double power = std::pow(sampleRate, model.alpha);
    const auto weights = gruenwaldWeights(model.alpha, static_cast<std::size_t>(N));
    const Eigen::Map<const Eigen::VectorXd> w(weights.data(), N);
    const RealLu lu(power * MatrixXd::Identity(n, n) - model.form.A);
    MatrixXd past(n, N), output(N, model.form.outputs());  // columns newest last
    for (Index t = 0; t < N; ++t) {
        if (t == 0)
            past.col(0).setZero();
        else
            past.col(t) = lu.solve(model.form.B * input.row(t).transpose()
                                   - power * (past.leftCols(t) * w.segment(1, t).reverse()));
        output.row(t) = (model.form.C * past.col(t) + model.form.D * input.row(t).transpose()).transpose();
    }
    return output;
}

}  // namespace excursion
