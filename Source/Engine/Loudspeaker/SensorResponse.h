// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <array>
#include <complex>
#include <optional>
#include <vector>

namespace excursion {

/// How a recorder takes a channel beside the drive,
///     H(s) = exp(-s (lag - q T)) / (1 + q T s + T^2 s^2).
/// The lag is that of low frequencies: converters that sample one after the other, filters that are not alike, a laser
/// whose latency is declared in round numbers. A hundredth of a sample turns the phase of a current at 2 kHz by
/// 0.003 rad, -51 dB, which no other parameter of a driver can be. A sensor of motion has a corner, too, of
/// quality 1/q at 1/(2 pi T): a laser's electronics, an accelerometer's resonance. These are parameters of the path. A
/// larger lag is reported by the check of the take. The sound has its own parameter, as it is on the way much longer.
struct SensorResponse {
    double lag = 0.0;  ///< s
    double T = 0.0;    ///< s
    double q = 0.0;

    /// Whether it tells everything at once.
    bool immediate() const { return lag == 0.0 && T == 0.0; }

    std::complex<double> operator()(std::complex<double> s) const;

    /// d ln H by lag, T and q.
    std::array<std::complex<double>, 3> logSlopes(std::complex<double> s) const;
};

/// The places of a quantity's lag, T and q among the parameters of the path: one of a current, none of a pressure or a
/// drive.
std::vector<Eigen::Index> sensorPlaces(Quantity);

/// That of a quantity; immediate where it has no such parameters.
SensorResponse sensorOf(const Model&, Quantity);

/// The model with sensors that tell everything at once.
Model withoutSensors(Model);

/// H Y of all lines k, s = j k step.
/// @param step  rad/s
void passSensor(std::vector<std::complex<double>>& spectrum, double step, const SensorResponse&);

/// The parameters of the path that say something: without those of sensors that are zero, as nothing tells them.
std::vector<Parameter> toldOfPath(const Model&);

}  // namespace excursion
