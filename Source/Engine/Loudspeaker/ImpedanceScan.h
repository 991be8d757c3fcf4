// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/FitResponse.h"

#include <optional>

namespace excursion {

/// First estimates from an impedance.
struct ImpedanceShape {
    double Re = 0.0;             ///< ohm
    double Le = 0.0;             ///< H, best inductance without a semi-inductance
    double height = 0.0;         ///< Bl^2/Rms, ohm
    double resonance = 0.0;      ///< Hz
    double quality = 0.0;        ///< mechanical, sqrt(K m)/Rms
    double relativeError = 1.0;  ///< relative rms error of the shape with the semi-inductance
};

/// Fits
///     Z = Re + L s + E s^1/2 + H s (w0/Q) / (s^2 + s w0/Q + w0^2),   all coefficients >= 0,
/// by linear least squares on a grid of resonance and quality, so that no start value is needed and the peak is found
/// even if a simple inductance fits badly [B 5]. nullopt if no grid point has a positive Re and peak.
/// @param target  target of the current: an impedance or its reciprocal
std::optional<ImpedanceShape> scanImpedance(const ResponseTarget& target);

}  // namespace excursion
