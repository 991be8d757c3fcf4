// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/BlackBox/PreviewControl.h"

#include "Engine/Numerics/LuFactors.h"

#include <cmath>

namespace excursion {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The stabilizing solution P of the Riccati equation of A, G = B B^T / r, H, by structure-preserving doubling
/// (Chu, Fan, Lin & Wang 2004).
std::optional<MatrixXd> riccati(MatrixXd A, MatrixXd G, MatrixXd H)
{
    const auto I = MatrixXd::Identity(A.rows(), A.rows());
    for (int k = 0; k < 60; ++k) {
        const RealLu solver(I + G * H);
        const MatrixXd WA = solver.solve(A), WG = solver.solve(G);
        const MatrixXd more = A.transpose() * H * WA;
        G += A * WG * A.transpose();
        G = (0.5 * (G + G.transpose())).eval();
        H += 0.5 * (more + more.transpose());
        A = (A * WA).eval();
        if (!H.allFinite() || !G.allFinite())
            return std::nullopt;
        if (more.norm() <= 1e-14 * H.norm())
            return H;
    }
    return std::nullopt;
}

}  // namespace

std::optional<PreviewControl> previewControl(const StateSpace& system, const MatrixXd& E, const MatrixXd& F,
                                             double cost, int preview)
{
    const auto n = system.order();
    const double D = system.D(0, 0), R = D * D + cost;
    PreviewControl control;
    // States in units in which they are reached alike: a triangle of the Gramian would be more, a scale is enough.
    VectorXd scale = VectorXd::Zero(n), x = system.B.col(0);
    for (int t = 0; t < 4096; ++t) {
        scale = scale.cwiseMax(x.cwiseAbs());
        x = (system.A * x).eval();
    }
    for (auto& one : scale)
        one = one > 0.0 ? one : 1.0;
    const MatrixXd A = scale.cwiseInverse().asDiagonal() * system.A * scale.asDiagonal(),
                   B = scale.cwiseInverse().asDiagonal() * system.B, disturbed = scale.cwiseInverse().asDiagonal() * E;
    const Eigen::RowVectorXd C = system.C * scale.asDiagonal();
    // Without the product of output and input in the cost, in units in which the cost of w^2 is 1.
    const MatrixXd plain = A - B * (D / R) * C;
    const auto P = riccati(plain, B * B.transpose() / R, C.transpose() * C * (cost / R));
    if (!P)
        return std::nullopt;
    const double M = R + (B.transpose() * *P * B)(0, 0);
    const Eigen::RowVectorXd K = (B.transpose() * *P * A + D * C) / M;
    const MatrixXd closed = A - B * K;
    StateSpace loop;
    loop.A = closed;
    loop.B = B;
    loop.C = C;
    loop.D = system.D;
    loop.sampleRate = system.sampleRate;
    if (!loop.isValid() || !(stabilityMargin(loop) > -1e-9))
        return std::nullopt;
    control.K = K * scale.cwiseInverse().asDiagonal();
    control.g.resize(E.cols(), preview + 1);
    if (E.cols() > 0) {
        const MatrixXd source = closed.transpose() * *P * disturbed + (C - D * K).transpose() * F;
        control.g.col(0) = (B.transpose() * *P * disturbed + D * F).transpose() / M;
        Eigen::RowVectorXd coast = B.transpose() / M;
        for (int j = 1; j <= preview; ++j) {
            control.g.col(j) = (coast * source).transpose();
            coast = (coast * closed.transpose()).eval();
        }
    }
    return control;
}

}  // namespace excursion
