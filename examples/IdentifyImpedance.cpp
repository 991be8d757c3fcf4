// SPDX-License-Identifier: GPL-3.0-or-later
// The impedance of a loudspeaker on 200 frequencies becomes a linear model of order 3, from which its resonance and
// losses are read.
#include "Engine/Linear/Identify.h"
#include "Engine/Linear/RationalLeastSquares.h"
#include "Engine/Linear/Response.h"

#include <cmath>
#include <iostream>
#include <numbers>
#include <random>

using namespace excursion;

constexpr double Re = 5.6, Le = 0.4e-3, Bl = 7.2, m = 0.02, Rms = 1.5, K = 1800.0;  // SI units

int main()
{
    // What a meter would show: Z = Re + s Le + Bl^2 s / (m s^2 + Rms s + K), with noise of 0.1 %. Z grows with
    // frequency for ever, which a state-space model cannot; so the model is of the admittance 1/Z, the current that a
    // voltage drives.
    std::mt19937 generator(1);
    std::normal_distribution<double> noise(0.0, 1e-3 / std::numbers::sqrt2);
    Frf admittance;
    for (int k = 0; k < 200; ++k) {
        const double f = 10.0 * std::pow(500.0, k / 199.0);  // 10 Hz to 5 kHz
        const std::complex<double> s(0.0, 2.0 * std::numbers::pi * f);
        const auto measured = (Re + s * Le + Bl * Bl * s / (m * s * s + Rms * s + K))
                              * (1.0 + std::complex(noise(generator), noise(generator)));
        admittance.frequency.push_back(f);
        admittance.value.push_back(1.0 / measured);
        admittance.noiseVariance.push_back(1e-6 * std::norm(1.0 / measured));
    }

    IdentifyOptions options;
    options.order = 3;
    const auto data = frequencyDataOf(admittance);
    const auto result = identify(data, options);
    std::cout << "error " << result.errorDb << " dB, " << (result.stable ? "stable" : "not stable") << "; "
              << result.refinement.message << "\n";

    // What linear least squares make of it (Levy 1959, invfreqz), which count the error more where the denominator is
    // large.
    const auto levy = fitRational(data, {.order = 3}).fit;
    std::cout << "Levy's least squares: error "
              << relativeErrorDb(admittance, frfOf(realize(levy.sections, levy.C, levy.D), admittance.frequency))
              << " dB\n";

    // The zeros of the admittance are the poles of the impedance: 0, and the mechanical resonance.
    for (const auto zero : zeros(result.model)) {
        if (zero.imag() <= 0.0)
            continue;
        const double f0 = std::abs(zero) / (2.0 * std::numbers::pi), q = std::abs(zero) / (-2.0 * zero.real());
        std::cout << "resonance " << f0 << " Hz, Qms " << q << "\n";
        const double trueF0 = std::sqrt(K / m) / (2.0 * std::numbers::pi), trueQ = std::sqrt(K * m) / Rms;
        const bool right = result.stable && std::abs(f0 / trueF0 - 1.0) < 2e-3 && std::abs(q / trueQ - 1.0) < 1e-2;
        return right ? 0 : 1;
    }
    return 1;
}
