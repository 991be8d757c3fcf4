// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Predistortion/Drivers.h"

#include "Bench/Bench.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Predistortion/Predistorter.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

// Targets of predistortion in closed form, and what drivers do exactly.
namespace excursion::test {

/// Of the bench's driver, by Thiele and Small.
inline Resonance ownOf(const bench::Loudspeaker& d)
{
    return {std::sqrt(d.K / d.m) / (2.0 * std::numbers::pi), std::sqrt(d.K * d.m) / (d.Rms + d.Bl * d.Bl / d.Re)};
}

/// s^2 + (w/Q) s + w^2
inline std::complex<double> quadratic(const Resonance& one, double frequency)
{
    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * frequency);
    const double w = 2.0 * std::numbers::pi * one.frequency;
    return s * s + s * w / one.quality + w * w;
}

/// x/u of the driver with another resonance in place of its own.
inline std::complex<double> targetResponse(const bench::Loudspeaker& driver, const Resonance& wanted, double frequency)
{
    return driver.small(frequency).displacement * quadratic(ownOf(driver), frequency) / quadratic(wanted, frequency);
}

inline PredistortionControls towards(double frequency, double quality)
{
    PredistortionControls controls;
    controls.target = {Target::Kind::resonance, frequency, quality, 0.02};
    return controls;
}

inline Measurement exact(const Model& model, const std::vector<double>& u, double sampleRate)
{
    SimulationOptions options;
    options.tolerance = 1e-7;
    return simulate(model, u, sampleRate, options);
}

}  // namespace excursion::test
