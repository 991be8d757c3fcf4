// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace excursion {

/// A number for each band of a third of an octave from 20 Hz to 20 kHz; the bands are counted from the one of 1 kHz.
using ThirdOctaves = std::array<double, 31>;

inline double thirdOctave(std::size_t k) { return 1000.0 * std::exp2((static_cast<double>(k) - 17.0) / 3.0); }  ///< Hz

}  // namespace excursion
