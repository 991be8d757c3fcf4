// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/OutputError.h"

#include <string>
#include <vector>

namespace excursion {

/// The forces and voltages that the model lacks, against the motion. With the model linearized at rest,
///     voltage = Z_e(jw) e_i + Bl j w e_x,   force = (K + Rms s + m s^2 + ...) e_x - Bl e_i,
/// from the errors e of current and displacement (or as much of it as the channels give), sorted by the simulated x, v
/// and i. Against the time they are the resistance and the stiffness that a section lacks,
///     -Re(i* voltage)/|i|^2   and   -Re(x* force)/|x|^2,   summed over its lines,
/// as the balances have -R i and -K x.
struct ResidualCurve {
    std::string residual;  ///< "force" or "voltage"; "stiffness" or "resistance" against the time
    std::string unit;      ///< "N" or "V"; "N/m" or "ohm"
    std::string against;   ///< "x", "v", "i" or "t"
    std::string againstUnit;
    /// mean and standard deviation in each bin; against the time, of each section and with its standard error
    std::vector<double> argument, mean, scatter;
    /// the residual's rms over the rms of the drive: the voltage, or the force Bl i; against the time over Re or K
    double db = 0.0;
};

/// The residual force and voltage at the loudest level of some simulated sections, in bins of x, v and i. None unless
/// the channels tell the displacement (also velocity, acceleration) and, of a driver with a coil, the current.
std::vector<ResidualCurve> residualCurves(const Model&, const Record&, const std::vector<std::size_t>& sections,
                                          const std::vector<SectionFit>& fits);

/// The places of the sections, in their order in the take.
std::vector<std::size_t> sectionsInTime(const Record&);

/// The residual stiffness and resistance of each section against its time in the take: a coil that warms and a
/// suspension that wanders show there. None where residualCurves() has none, or for fewer than three sections.
/// @param fits  of all sections of the record, with spectra
std::vector<ResidualCurve> curvesOverTime(const Model&, const Record&, const std::vector<SectionFit>& fits);

}  // namespace excursion
