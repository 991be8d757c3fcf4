// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/StateSpace.h"
#include "Engine/Polynomial/InputOutputRecord.h"
#include "Engine/Signal/Fft.h"
#include "Linear/Problem.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace excursion::test {

/// One period of a flat random-phase multisine through a model of three states with all products of two states in every
/// equation [B 4.4.1], from rest; the recursion is written out by itself.
/// @param level   rms of the input
inline InputOutputRecord quadraticRecord(const StateSpace& linear, double strength, double level, Normal& normal)
{
    constexpr Eigen::Index N = 4096;
    std::vector<std::complex<double>> spectrum(N / 2 + 1);
    for (std::size_t k = 1; k < N / 2; ++k)
        // wrapped this often, a phase is uniform
        spectrum[k] = std::polar(1.0, 2.0 * std::numbers::pi * normal());
    const auto period = inverseFft(spectrum, N);
    Eigen::MatrixXd u = Eigen::Map<const Eigen::VectorXd>(period.data(), N);
    u *= level * std::sqrt(static_cast<double>(N)) / u.norm();
    Eigen::MatrixXd y(N, 1);
    Eigen::Vector3d x = Eigen::Vector3d::Zero();
    for (Eigen::Index t = 0; t < N; ++t) {
        double products = 0.0;
        for (Eigen::Index i = 0; i < 3; ++i)
            for (Eigen::Index j = i; j < 3; ++j)
                products += x[i] * x[j];
        y(t, 0) = linear.C.row(0).dot(x) + linear.D(0, 0) * u(t, 0) + strength * products;
        x = (linear.A * x + linear.B * u(t, 0) + Eigen::Vector3d::Constant(strength * products)).eval();
    }
    return {u, y, 0, false};
}

}  // namespace excursion::test
