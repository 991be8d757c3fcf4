// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Bench/Random.h"
#include "Engine/Take/Measurement.h"

#include <vector>

namespace excursion::bench {

/// The DFT lines that a multisine excites within the band: full (every line), odd (odd lines), or odd-random (odd
/// lines, of which one is left out at random in each group of `detectionGroup` consecutive odd lines).
inline constexpr int detectionGroup = 4;
std::vector<int> excitedLines(const Excitation&, double sampleRate, Random&);

/// One period of a random-phase multisine of 1 V rms:
///     u(n) = sum_k A_k cos(2 pi k n / N + phi_k),  A_k of shape white (1), pink (f^-1/2) or red (f^-1)
std::vector<double> multisine(const Excitation&, const std::vector<int>& lines, Random&);

/// The whole drive: level by level, realization by realization, settling and kept periods, then `tail` more samples
/// that continue the last period and fade out. The phases of a realization are the same at every level. If one
/// multisine follows another, the old one continues for 256 samples of the new one's settling time, and the two are
/// crossfaded over the next 1024 (an error function, so that nothing leaves the band). The first one fades in. So every
/// kept period is exactly periodic up to its last sample. With `jumps` one follows the other at once, as in the file of
/// a plain player.
std::vector<double> drive(const Excitation&, double sampleRate, std::uint64_t seed, int tail, bool jumps = false);

}  // namespace excursion::bench
