// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <optional>

namespace excursion {

/// What a person knows of a driver from elsewhere, in SI units.
struct KnownScale {
    std::optional<double> mass {};         ///< kg, of all that moves
    std::optional<double> forceFactor {};  ///< N/A
    std::optional<double> coneArea {};     ///< m^2
};

/// A model with what is known put in, and what of it is a guess still.
struct ScaledModel {
    Model model;

    /// A take of voltage and current alone shows Bl^2/m, Rms/m and K/m: the model's motion could be any multiple of
    /// itself.
    bool motionIsGuessed = false;

    /// No sound was measured, and the take did not tell the area of the cone (Radiation's default of 0.01 m^2).
    bool areaIsGuessed = false;
};

/// The model whose coil and sound are the same and whose cone moves `factor` times as far: a unit of length that is
/// `factor` times as small, in which energies and currents are what they were (m, Rms, K go with factor^-2, Bl, forces
/// and, where the sound tells it, Sd with factor^-1). Laws, operating ranges, standard errors and the covariance go
/// along.
Model withMotion(Model, double factor);

/// Puts in what is known.
/// @throws Error (usage) for two numbers of which one follows from the other, for a mass or a force factor that the
/// take has shown itself, and for numbers that are not positive
ScaledModel withKnown(Model, const KnownScale&);

}  // namespace excursion
