// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace excursion {

// The air of a room, as models and datasheets take it.
inline constexpr double airDensity = 1.2;           ///< kg/m^3
inline constexpr double speedOfSound = 343.0;       ///< m/s
inline constexpr double referencePressure = 20e-6;  ///< Pa, 0 dB of a sound pressure level

}  // namespace excursion
