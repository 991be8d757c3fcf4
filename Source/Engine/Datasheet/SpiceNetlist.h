// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <string>

namespace excursion {

/// The linear part of a model as a subcircuit for SPICE (ngspice, LTspice), in plain ASCII: resistors, inductors and
/// capacitors alone, and for the motor a voltage source and a current source that are controlled by one another (u = Bl
/// v, F = Bl i). Mechanics are in the mobility analogy (Network). Terminals: "plus minus cone", of which the last one's
/// voltage is the cone's velocity in m/s; of a model without a coil "cone", into which the force is put as a current.
/// Comments say what each part stands for and which effects are left out.
/// @param name  of the subcircuit; what SPICE would not take is replaced
std::string spiceNetlist(const Model&, const std::string& name);

}  // namespace excursion
