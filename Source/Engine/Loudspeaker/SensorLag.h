// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/Record.h"
#include "Engine/Loudspeaker/Model.h"

#include <complex>
#include <optional>
#include <vector>

namespace excursion {

// How much later than the drive a recorder takes a channel: converters that sample one after the other, filters that
// are not alike, a laser whose latency is declared in round numbers. A hundredth of a sample turns the phase of a
// current at 2 kHz by 0.003 rad, -51 dB, which no other parameter of a driver can be. What is seen of a quantity is
//     Y(w) exp(-j w tau),
// with tau a parameter of the path. A larger lag is reported by the check of the take. The sound has its own parameter,
// as it is on the way much longer.

/// The place of a quantity's lag among the parameters of the path; none of a pressure or a drive.
std::optional<Eigen::Index> lagPlace(Quantity);

/// s; zero where there is no such parameter.
double lagOf(const Model&, Quantity);

/// The model with sensors that tell everything at once.
Model withoutLags(Model);

/// Lets the lags of the channels of a record be fitted that can tell them: that of periods with a known noise. They are
/// expected to turn the phase by no more than 0.05 rad: of a current at the end of the band, of a motion in its middle.
void freeLags(Model&, const Record&);

/// Y exp(-j w tau) of all lines k, w = k step.
/// @param step  rad/s
void lag(std::vector<std::complex<double>>& spectrum, double step, double tau);

/// d/d tau of what is seen: -j w Y exp(-j w tau).
/// @param seen  Y exp(-j w tau)
std::vector<std::complex<double>> lagSlope(std::vector<std::complex<double>> seen, double step);

/// The parameters of the path that say something: without lags that are zero, as nothing tells them.
std::vector<Parameter> toldOfPath(const Model&);

}  // namespace excursion
