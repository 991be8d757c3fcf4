// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Datasheet/KnownScale.h"

#include <limits>
#include <string>
#include <vector>

namespace excursion {

/// What the sound of a datasheet is referred to.
inline constexpr double sheetVoltage = 2.83;  ///< V; and referencePressure

/// A number of a datasheet.
struct DatasheetFigure {
    std::string symbol;  ///< "fs", "Qts", "Vas"
    /// of `value`, SI: "m^3"; "1" of a pure number
    std::string unit;
    std::string sheetUnit;  ///< as datasheets have it: "l"
    /// the number in a datasheet is value * perUnit
    double perUnit = 1.0;
    std::string meaning;                                              ///< "equivalent volume"
    double value = std::numeric_limits<double>::quiet_NaN();          ///< NaN: cannot be said
    double standardError = std::numeric_limits<double>::quiet_NaN();  ///< NaN: not known
    /// why it cannot be said; empty where it can
    std::string why {};
};

/// Thiele/Small parameters of the driver without its box, for small signals, at the resonance as the whole linear model
/// has it (Small, "Direct-Radiator Loudspeaker System Analysis", J. Audio Eng. Soc. 20, 1972). With Z(j w) force over
/// velocity of the open coil's cone,
///     fs:   Im Z = 0
///     Mms = 1/2 (d Im Z/dw + Im Z/w) there, of the model without what creeps
///     Cms = 1/(ws^2 Mms),   Rms = Re Z,   Qms = ws Mms/Rms,   Qes = ws Mms Re/Bl^2,   1/Qts = 1/Qms + 1/Qes
///     Vas = rho c^2 Sd^2 Cms,   eta0 = rho/(2 pi c) Bl^2 Sd^2/(Re Mms^2)   (half space)
///     sensitivity at 1 m = 20 log10( rho/(2 pi) Bl Sd/(Re Mms) u / 20 uPa ),   u = (1 W Re)^1/2, or 2.83 V
///     Le = Im Z_blocked/w at 1 kHz,   Re as resistanceFrequency() has it (Impedances.h)
/// so a suspension that creeps has the stiffness and the losses that it has at resonance, and a surround that swings by
/// itself counts as mass. Of the base alone these are its parameters. rho = 1.2 kg/m^3, c = 343 m/s. Standard errors
/// are sqrt(g^T C g), g by central differences; what was given has none. What changes with a scale that is only a guess
/// is not said. The order is that of a datasheet.
/// @throws Error (data) when the linear model has no resonance of the cone
std::vector<DatasheetFigure> thieleSmall(const ScaledModel&);

}  // namespace excursion
