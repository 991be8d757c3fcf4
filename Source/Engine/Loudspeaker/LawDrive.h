// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Loudspeaker/ShownMotion.h"

#include <Eigen/Core>

#include <cstddef>
#include <memory>
#include <vector>

namespace excursion {

/// The derivatives of a law's contribution by all that valuesOf() holds, one entry each. Empty if not asked for or
/// zero.
struct LawSlopes {
    std::vector<double> at;                      ///< the law's values where they were taken
    std::vector<bool> wanted;                    ///< of these, those that were differentiated by
    std::vector<Spectrum> voltage, force, flow;  ///< the first lines, as many as asked for
    std::vector<std::vector<double>> lateness;
};

/// The contribution of a law for a given motion of one section, as spectra of its window.
struct LawDrive {
    Spectrum voltage;                         ///< drop + fluxSlope v + inductance di/dt, V
    Spectrum force;                           ///< force - mass dv/dt, N
    Spectrum flow;                            ///< m/s^2, what it adds to the emission beside the cone; empty if nothing
    std::vector<double> lateness;             ///< s, one value per sample; empty if the law emits nothing
    std::shared_ptr<const LawSlopes> slopes;  ///< none unless asked for

    /// Whether it adds lateness, or sound beside the cone, or its slopes do, which may be at no strength yet.
    bool isLate() const;
    bool radiates() const;
};

/// Whether the slopes of a law depend on the motion alone: it is linear in its parameters and has no memory. Tried at
/// a few points, so no effect has to declare it.
bool hasConstantSlopes(const Component&);

/// Whether a law's memory has forgotten its start value after a quarter of the motion's period.
bool forgetsInAQuarter(const Component&, const ShownMotion&, double sampleRate);

/// Evaluates the law, which is not a linear effect, along the motion. Its memory is integrated and differentiated from
/// its start: exactly along parabolas between half samples if each state decays at a constant rate, else by the
/// fourth-order Runge-Kutta method.
/// @param start      start value of its memory, a quarter of a period before the window
/// @param wanted     values to differentiate by: one flag for each of valuesOf(), or none
/// @param lines      of the slopes' spectra, from 0 Hz
LawDrive driveOf(const Component&, const ShownMotion&, const MemoryStart& start, double sampleRate,
                 const std::vector<bool>& wanted, std::size_t lines);

}  // namespace excursion
