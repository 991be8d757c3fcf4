// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/OutputError.h"

#include <string>
#include <vector>

namespace excursion {

/// The forces and voltages that the model lacks, against the motion. With the model linearized at rest,
///     voltage = Z_e(jw) e_i + Bl j w e_x,   force = (K + Rms s + m s^2 + ...) e_x - Bl e_i,
/// from the errors e of current and displacement (or as much of it as the channels give), sorted by the simulated x, v
/// and i.
struct ResidualCurve {
    std::string residual;  ///< "force" or "voltage"
    std::string unit;      ///< "N" or "V"
    std::string against;   ///< "x", "v" or "i"
    std::string againstUnit;
    std::vector<double> argument, mean, scatter;  ///< mean and standard deviation in each bin
    double db = 0.0;  ///< the residual's rms over the rms of the drive: the voltage, or the force Bl i
};

/// The residual force and voltage at the loudest level of some simulated sections, in bins of x, v and i. Without a
/// channel that gives the displacement (also velocity, acceleration) there is no force. Without current there is no
/// voltage, unless the driver is mechanical-only.
std::vector<ResidualCurve> residualCurves(const Model&, const Record&, const std::vector<std::size_t>& sections,
                                          const std::vector<SectionFit>& fits);

}  // namespace excursion
