// SPDX-License-Identifier: GPL-3.0-or-later
// The response that an FFT analyzer shows, on evenly spaced frequencies, becomes a state-space model by two subspace
// methods: one for even spacing, which takes the response back into time, and one for any frequencies.
#include "Engine/Linear/Response.h"
#include "Engine/Linear/Subspace.h"

#include <cmath>
#include <iostream>
#include <numbers>
#include <tuple>
#include <vector>

using namespace excursion;

constexpr double sampleRate = 2000.0, f1 = 60.0, q1 = 1.5, f2 = 310.0, q2 = 20.0;  // Hz; a cone and a mode of it
constexpr int order = 4, lines = 257, blockRows = 20;

int main()
{
    StateSpace truth;
    truth.sampleRate = sampleRate;
    truth.A = Eigen::MatrixXd::Zero(order, order);
    for (const auto& [place, f, q] : {std::tuple(0, f1, q1), std::tuple(2, f2, q2)}) {
        const double w = 2.0 * std::numbers::pi * f / sampleRate, r = std::exp(-0.5 * w / q);
        const double angle = w * std::sqrt(1.0 - 0.25 / (q * q));
        truth.A.block<2, 2>(place, place) << r * std::cos(angle), r * std::sin(angle), -r * std::sin(angle),
            r * std::cos(angle);
    }
    truth.B = Eigen::Vector4d(0.3, 0.0, 0.02, 0.0);
    truth.C = Eigen::RowVector4d(0.0, 1.0, 0.0, 1.0);
    truth.D = Eigen::MatrixXd::Zero(1, 1);

    std::vector<double> frequency;
    for (int k = 0; k < lines; ++k)
        frequency.push_back(0.5 * sampleRate * k / (lines - 1));
    const auto response = frfOf(truth, frequency);
    const auto data = frequencyDataOf(response);

    auto even = dynamicsOf(observabilityRangeUniform(data, sampleRate, blockRows), order, 1, true);
    fitInputs(even, data);
    const auto any = identifySubspace(data, sampleRate, order);

    const double evenDb = relativeErrorDb(response, frfOf(even, frequency)),
                 anyDb = relativeErrorDb(response, frfOf(any, frequency));
    std::cout << "error: even spacing " << evenDb << " dB, any frequencies " << anyDb << " dB\n";
    for (const auto pole : poles(even))
        if (pole.imag() > 0.0)
            std::cout << "resonance " << std::abs(std::log(pole)) * sampleRate / (2.0 * std::numbers::pi) << " Hz, Q "
                      << std::abs(std::log(pole)) / (-2.0 * std::log(std::abs(pole))) << "\n";
    return evenDb < -200.0 && anyDb < -200.0 ? 0 : 1;
}
