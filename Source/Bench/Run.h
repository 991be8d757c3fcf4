// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Bench/Loudspeaker.h"
#include "Engine/Progress.h"
#include "Engine/Take/Measurement.h"

#include <map>
#include <span>
#include <vector>

namespace excursion::bench {

/// The signals of perfect sensors, at the finer rate of the simulation.
struct Record {
    double sampleRate = 0.0;  ///< Hz, of the played voltage
    int oversampling = 1;
    std::map<Quantity, std::vector<double>> signals;  ///< oversampling * played samples each
    double coilTemperature = 0.0;                     ///< K above the room, at the end
};

/// Steps per sample: the smallest power of two that gives at least 176 kHz, and twice as many for
/// eddy currents, whose fastest cells lower the order of the method from 5 to 4. Each step has three points.
int defaultOversampling(const Loudspeaker&, double sampleRate);

/// Plays a voltage from rest through an ideal converter (band-limited interpolation, exact at every point that the
/// simulation uses) and an amplifier without output impedance. `voltage` should begin and end in silence or fade; its
/// band should end below 0.45 sampleRate. Pressure (in Pa, 2 pi radiation as far field): p(t) = rho Sd/(2 pi d) a(t'),
/// t' = t - d/c, or with the Doppler effect t' = t - (d - x(t'))/c; rho = 1.2 kg/m^3, c = 343 m/s.
/// @param lowest  Hz, down to which the fractional elements are accurate
Record run(const Loudspeaker&, std::span<const double> voltage, double sampleRate,
           const std::vector<Quantity>& channels, double microphoneDistance, double lowest, int oversampling = 0,
           const Progress& = {});

}  // namespace excursion::bench
