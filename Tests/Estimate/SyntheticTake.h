// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/Measurement.h"

#include <complex>
#include <random>
#include <vector>

namespace excursion::synthetic {

/// A loudspeaker in steady state, solved line by line in the frequency domain; nonlinear forces and voltages
/// enter by Picard iteration. Shares no code with the engine but the DFT. The defaults are the driver of [B 2.2].
struct Loudspeaker {
    double m = 14.35e-3, r = 0.786, k = 1852.0, Bl = 4.95, L = 266e-6, R = 3.3;
    double semiK = 0.0, semiExponent = 0.7;  ///< adds semiK s^a to the blocked impedance
    /// k / (1 + creep log(w0 / s) / ln 10): compliance grows as frequency falls
    double creep = 0.0;
    double evenStiffness = 0.0, oddStiffness = 0.0;  ///< k (1 + even x/xRef + odd (x/xRef)^2)
    double evenForce = 0.0, oddForce = 0.0;          ///< Bl (1 - even x/xRef - odd (x/xRef)^2)
    double xReference = 1e-3;                        ///< m
    double microphoneDelay = 0.9e-3;                 ///< s

    double resonance() const;  ///< rad/s
    std::complex<double> blockedImpedance(std::complex<double> s) const;
    std::complex<double> mechanicalImpedance(std::complex<double> s) const;  ///< force / displacement
    std::complex<double> impedance(std::complex<double> s) const;            ///< voltage / current
    std::complex<double> displacementPerVoltage(std::complex<double> s) const;
};

struct Plan {
    double sampleRate = 48000.0;
    int period = 8192;
    int settlePeriods = 1, periods = 3, realizations = 3;
    std::vector<double> levels {0.5, 2.0};
    double bandLow = 15.0, bandHigh = 8000.0;  ///< Hz
    bool pink = true;
    double noiseDb = -300.0;  ///< white, of each channel, relative to its rms at the loudest level
    bool force = false;       ///< mechanical-only: force in, displacement out
    std::vector<Quantity> outputs {Quantity::current, Quantity::displacement};
    bool everyOdd = false;  ///< the grid has all odd lines
};

/// Lines of an odd-random grid: one odd line at random left out of each four, or none.
std::vector<int> oddRandomLines(const Plan&, std::mt19937_64&);

/// The take, settled from the first sample and half a period longer than its excitation.
Measurement record(const Loudspeaker&, const Plan&, std::mt19937_64&);

/// Adds white Gaussian noise.
void addNoise(std::vector<double>& samples, double rms, std::mt19937_64&);

double rms(const std::vector<double>&);

/// The samples as if taken later by `samples`(n) at sample n, by windowed-sinc interpolation: a delay of
/// offset + slope * n samples. Beyond the ends the record is zero.
std::vector<double> delayed(const std::vector<double>& x, double offset, double slope = 0.0);

}  // namespace excursion::synthetic
