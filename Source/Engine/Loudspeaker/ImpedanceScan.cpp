// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/ImpedanceScan.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace excursion {
namespace {

using Complex = std::complex<double>;
constexpr int terms = 4;  // Re, L s, E s^1/2, peak
using Vector = Eigen::Vector4d;
using Matrix = Eigen::Matrix4d;

struct Curve {
    std::vector<double> omega;
    std::vector<Complex> impedance;
    std::vector<double> weight;  // of the squared error
    double power = 0.0;          // weighted
};

Curve curveOf(const ResponseTarget& target)
{
    Curve curve;
    for (std::size_t k = 0; k < target.frequency.size(); ++k) {
        const Complex Z = target.impedance ? target.value[k] : 1.0 / target.value[k];
        const double deviation = target.deviation[k] * (target.impedance ? 1.0 : std::norm(Z));
        if (!std::isfinite(std::norm(Z)) || !(deviation > 0.0) || !std::isfinite(deviation))
            continue;
        curve.omega.push_back(2.0 * std::numbers::pi * target.frequency[k]);
        curve.impedance.push_back(Z);
        curve.weight.push_back(1.0 / (deviation * deviation));
        curve.power += std::norm(Z) / (deviation * deviation);
    }
    return curve;
}

/// The least-squares coefficients, with those that would be negative held at zero, and what they leave.
struct Solution {
    Vector coefficients = Vector::Zero();
    double cost = 0.0;
};

Solution solve(const Matrix& N, const Vector& g, double power, std::array<bool, terms> use)
{
    Solution solution;
    for (int round = 0; round < terms; ++round) {
        Matrix A = N;
        Vector b = g;
        for (int k = 0; k < terms; ++k)
            if (!use[static_cast<std::size_t>(k)]) {
                A.row(k).setZero();
                A.col(k).setZero();
                A(k, k) = N(k, k);
                b[k] = 0.0;
            }
        solution.coefficients = A.ldlt().solve(b);
        int lowest = 0;
        const double least = solution.coefficients.minCoeff(&lowest);
        if (least >= 0.0)
            break;
        use[static_cast<std::size_t>(lowest)] = false;
        solution.coefficients[lowest] = 0.0;
    }
    solution.cost = power - 2.0 * solution.coefficients.dot(g) + solution.coefficients.dot(N * solution.coefficients);
    return solution;
}

}  // namespace

std::optional<ImpedanceShape> scanImpedance(const ResponseTarget& target)
{
    const auto curve = curveOf(target);
    if (curve.omega.size() < terms)
        return std::nullopt;
    const double reference = curve.omega.back();  // scales the terms to about one ohm each
    // All that does not depend on the peak is summed once.
    Matrix fixed = Matrix::Zero();
    Vector fixedRight = Vector::Zero();
    std::vector<std::array<Complex, 3>> rows;
    for (std::size_t k = 0; k < curve.omega.size(); ++k) {
        const Complex s(0.0, curve.omega[k] / reference);
        rows.push_back({1.0, s, std::sqrt(s)});
        for (int r = 0; r < 3; ++r) {
            const auto conjugate = std::conj(rows.back()[static_cast<std::size_t>(r)]) * curve.weight[k];
            for (int c = 0; c < 3; ++c)
                fixed(r, c) += (conjugate * rows.back()[static_cast<std::size_t>(c)]).real();
            fixedRight[r] += (conjugate * curve.impedance[k]).real();
        }
    }
    std::optional<ImpedanceShape> best;
    double lowest = curve.power;
    constexpr double gridStep = 1.03;  // a quality of 15 is still seen
    for (double f0 = std::max(curve.omega.front(), 1e-4 * reference) / (2.0 * std::numbers::pi);
         f0 < 0.7 * reference / (2.0 * std::numbers::pi); f0 *= gridStep)
        for (const double Q : {0.4, 0.7, 1.2, 2.0, 3.5, 6.0, 10.0}) {
            const double w0 = 2.0 * std::numbers::pi * f0;
            Matrix N = fixed;
            Vector g = fixedRight;
            for (std::size_t k = 0; k < curve.omega.size(); ++k) {
                const double w = curve.omega[k];
                const Complex numerator(0.0, w * w0 / Q);
                const Complex peak = numerator / (w0 * w0 - w * w + numerator);
                const auto conjugate = std::conj(peak) * curve.weight[k];
                for (int c = 0; c < 3; ++c)
                    N(3, c) += (conjugate * rows[k][static_cast<std::size_t>(c)]).real();
                N(3, 3) += std::norm(peak) * curve.weight[k];
                g[3] += (conjugate * curve.impedance[k]).real();
            }
            N.col(3).head<3>() = N.row(3).head<3>();
            const auto full = solve(N, g, curve.power, {true, true, true, true});
            if (full.cost >= lowest || !(full.coefficients[0] > 0.0) || !(full.coefficients[3] > 0.0))
                continue;
            lowest = full.cost;
            const auto plain = solve(N, g, curve.power, {true, true, false, true});
            best = ImpedanceShape {std::max(plain.coefficients[0], full.coefficients[0]),
                                   plain.coefficients[1] / reference,
                                   full.coefficients[3],
                                   f0,
                                   Q,
                                   std::sqrt(std::max(0.0, full.cost) / curve.power)};
        }
    return best;
}

}  // namespace excursion
