// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace excursion {

/// A number for each third-octave band from 20 Hz to 20 kHz. The centres are defined from the band at 1 kHz.
using ThirdOctaves = std::array<double, 31>;

inline double thirdOctave(std::size_t k) { return 1000.0 * std::exp2((static_cast<double>(k) - 17.0) / 3.0); }  ///< Hz

}  // namespace excursion
