// SPDX-License-Identifier: GPL-3.0-or-later
// A woofer whose suspension hardens plays a tone of 20 Hz: how far its cone goes, and the harmonics of its motion.
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Signal/Fft.h"

#include <cmath>
#include <complex>
#include <iostream>
#include <numbers>

using namespace excursion;

constexpr double sampleRate = 48000.0, tone = 20.0, volts = 8.0;  // Hz, Hz, V peak

// Amplitudes of the displacement in mm: of the tone, of its second harmonic, its third, ...
std::vector<double> harmonics(const Model& model)
{
    std::vector<double> voltage(48000);
    for (std::size_t n = 0; n < voltage.size(); ++n)
        voltage[n] = volts * std::sin(2.0 * std::numbers::pi * tone * static_cast<double>(n) / sampleRate);
    const auto take = simulate(model, voltage, sampleRate, SimulationOptions {});

    // The last four periods, when the start has died away: the tone stands on line 4, its harmonics on 8, 12, ...
    const auto& x = take.find(Quantity::displacement)->samples;
    const std::size_t window = 4 * 2400;
    const auto spectrum = fft(std::span(x).last(window));
    std::vector<double> amplitudes;
    for (std::size_t h = 1; h <= 5; ++h)
        amplitudes.push_back(1e3 * 2.0 * std::abs(spectrum[4 * h]) / window);
    return amplitudes;
}

int main()
{
    Model linear = makeModel("electrodynamic");
    for (const auto& [name, value] :
         {std::pair {"Re", 5.6}, {"Le", 0.4e-3}, {"Bl", 7.2}, {"m", 0.02}, {"Rms", 1.5}, {"K", 1800.0}})
        linear.baseParameter(name).value = value;

    // K(x) = K + c1 T1(x/X) + c2 [T2(x/X) - T2(0)], Chebyshev's T2(s) - T2(0) = 2 s^2: c2 = K/2 doubles K at the ends.
    OperatingRange operatingRange;
    operatingRange.displacement = 6e-3;
    operatingRange.degree = 2;
    operatingRange.relaxed = false;  // no creep beside it
    Model hardening = withEffect(linear, effectNamed("stiffness"), operatingRange);
    hardening.components.back().parameters[1].value = 900.0;

    const auto without = harmonics(linear), with = harmonics(hardening);
    std::cout << "linear:    " << without[0] << " mm, harmonics " << without[1] << ", " << without[2] << " mm\n"
              << "hardening: " << with[0] << " mm, harmonics " << with[1] << ", " << with[2] << " mm\n";

    // In closed form: X = Bl U / (Ze Zm + j w Bl^2) with Ze = Re + j w Le and Zm = K - m w^2 + j w Rms.
    const double w = 2.0 * std::numbers::pi * tone;
    const std::complex<double> Ze(5.6, w * 0.4e-3), Zm(1800.0 - 0.02 * w * w, w * 1.5), damping(0.0, w * 7.2 * 7.2);
    const double truth = 1e3 * std::abs(7.2 * volts / (Ze * Zm + damping));
    const bool right = std::abs(without[0] / truth - 1.0) < 1e-4 && with[0] < 0.95 * without[0]
                       && with[2] > 100.0 * with[1];
    return right ? 0 : 1;
}
