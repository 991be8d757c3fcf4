// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

namespace excursion {

/// Levels over frequency, as a curve that is to be followed has them.
struct LevelCurve {
    std::vector<double> frequency;  ///< Hz, ascending, positive
    std::vector<double> db;
};

/// Reads lines of frequency in Hz, dB and, maybe, phase in degrees, which is not looked at (.frd, .txt, .csv).
/// Throws Error (input).
LevelCurve readLevelCurve(const std::filesystem::path&);

}  // namespace excursion
