// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <complex>
#include <span>
#include <vector>

namespace excursion {

/// How a recorder takes a channel beside the drive,
///     H(s) = exp(-s (lag - q T)) / (1 + q T s + T^2 s^2) (s + rolledOff) / (s + rolledOff + further).
/// The lag is that of low frequencies: converters that sample one after the other, filters that are not alike, a laser
/// whose latency is declared in round numbers. A hundredth of a sample turns the phase of a current at 2 kHz by
/// 0.003 rad, -51 dB, which no other parameter of a driver can be. A sensor of motion has a corner, too, of
/// quality 1/q at 1/(2 pi T): a laser's electronics, an accelerometer's resonance. A larger lag is reported by the
/// check of the take. A microphone rolls off, first order: the record has been corrected by a corner, and the right one
/// is a little further. Its sound has a time of flight in place of a lag. These are parameters of the path.
struct SensorResponse {
    double lag = 0.0;  ///< s
    double T = 0.0;    ///< s
    double q = 0.0;
    double rolledOff = 0.0;  ///< rad/s, by which the record has been corrected
    double further = 0.0;    ///< rad/s

    /// Whether it tells everything at once.
    bool immediate() const { return lag == 0.0 && T == 0.0 && further == 0.0; }

    std::complex<double> operator()(std::complex<double> s) const;

    /// d ln H/d one of these, away from s = 0.
    std::complex<double> logSlope(double SensorResponse::*by, std::complex<double> s) const;
};

/// Where a value of a sensor stands among the parameters of the path.
struct SensorParameter {
    Eigen::Index place;
    double SensorResponse::*value;
};

/// Those of a quantity: the lag of a current, lag, T and q of a motion, the corner of a pressure, none of a drive.
std::span<const SensorParameter> sensorParameters(Quantity);

/// That of a quantity; immediate where it has no such parameters.
SensorResponse sensorOf(const Model&, Quantity);

/// The model with sensors that tell everything at once.
Model withoutSensors(Model);

/// H Y of all lines k, s = j k step.
/// @param step  rad/s
void passSensor(std::vector<std::complex<double>>& spectrum, double step, const SensorResponse&);

/// What the parameters of the path say to a person: without those of sensors that no fit could tell, and with a
/// sensor's corner in Hz and its Q in place of T and q.
std::vector<Parameter> toldOfPath(const Model&);

}  // namespace excursion
