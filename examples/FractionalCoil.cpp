// SPDX-License-Identifier: GPL-3.0-or-later
// A voice coil in iron, u = R i + K d^a i/dt^a. A volt is switched on: how does the current rise? In three ways that
// share nothing: exactly, by a ladder of first-order memories, and by a difference that remembers all of the past. Then
// the current is put into the equation, and must give the volt back.
#include "Engine/Fractional/Operators.h"
#include "Engine/Fractional/TimeResponse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <vector>

using namespace excursion;

constexpr double R = 5.6, K = 0.05, a = 0.7, sampleRate = 10000.0;  // ohm, ohm s^a, 1, Hz
constexpr int samples = 2001;

int main()
{
    // D^a i = -(R/K) i + u/K: a model in s^a with one state, the current.
    FractionalStateSpace coil;
    coil.alpha = a;
    coil.form.A = Eigen::MatrixXd::Constant(1, 1, -R / K);
    coil.form.B = Eigen::MatrixXd::Constant(1, 1, 1.0 / K);
    coil.form.C = Eigen::MatrixXd::Ones(1, 1);
    coil.form.D = Eigen::MatrixXd::Zero(1, 1);

    std::vector<double> times, current;
    for (int n = 0; n < samples; ++n)
        times.push_back(n / sampleRate);
    for (const auto& value : stepResponse(coil, times))
        current.push_back(value(0, 0));
    const Eigen::MatrixXd volt = Eigen::MatrixXd::Ones(samples, 1);
    const auto ladder = simulateByLadder(coil, volt, sampleRate, {1.0, 1e6, 4.0});
    const auto difference = simulateByDifference(coil, volt, sampleRate);
    const double interval = 1.0 / sampleRate;
    // The three definitions of D^a, which agree where a signal begins at 0
    const std::array slopes {caputoDerivative(current, a, interval), riemannLiouvilleDerivative(current, a, interval),
                             gruenwaldLetnikov(current, a, interval)};

    double ladderError = 0.0, differenceError = 0.0, voltError = 0.0;
    for (int n = samples / 20; n < samples; ++n) {  // the first samples bend too much for the operators
        const double i = current[static_cast<std::size_t>(n)];
        ladderError = std::max(ladderError, std::abs(ladder(n, 0) / i - 1.0));
        differenceError = std::max(differenceError, std::abs(difference(n, 0) / i - 1.0));
        for (const auto& slope : slopes)
            voltError = std::max(voltError, std::abs(R * i + K * slope[static_cast<std::size_t>(n)] - 1.0));
    }
    // The response to an impulse is the slope of that to a step.
    const double slope = 0.5 * sampleRate * (current[101] - current[99]);
    const double impulseError = std::abs(impulseResponse(coil, {times[100]})[0](0, 0) / slope - 1.0);
    std::cout << "after 10 ms " << 1e3 * current[100] << " mA, after 200 ms " << 1e3 * current.back() << " mA of "
              << 1e3 / R << "\n"
              << "largest errors: ladder " << ladderError << ", difference " << differenceError << ", volt "
              << voltError << ", impulse " << impulseError << "\n";
    const bool right = ladderError < 1e-7 && differenceError < 2e-3 && voltError < 5e-3 && impulseError < 1e-4;
    return right ? 0 : 1;
}
