// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace excursion {

/// Which DFT lines k of one period may be excited ([B appendix A], `multisine`).
enum class Grid {
    full,       ///< every k
    odd,        ///< k = 1, 3, 5, ...
    oddOdd,     ///< k = 1, 5, 9, ...
    oddRandom,  ///< odd, but one at random left out of each group of consecutive odd lines
    R10,
    R20,
    R40,
    R80  ///< 10 .. 80 a decade: k = 10^(i/R) rounded to the nearest line
};

/// How the amplitude of a line goes with its frequency f: constant, 1/sqrt(f), 1/f.
enum class Shape { white, pink, red };

std::string_view name(Grid);   ///< "odd-random", as in the files
std::string_view name(Shape);  ///< "pink"
std::optional<Grid> gridNamed(std::string_view);
std::optional<Shape> shapeNamed(std::string_view);

struct MultisineOptions {
    double sampleRate = 48000.0;  ///< Hz
    int period = 16384;           ///< N, samples
    Grid grid = Grid::oddRandom;
    Shape shape = Shape::pink;
    double bandLow = 20.0;      ///< Hz; both ends belong to the band
    double bandHigh = 20000.0;  ///< Hz; at most half the sample rate
    double rms = 1.0;           ///< V
    int groupSize = 4;          ///< odd-random: lines in a group that misses one
    std::uint64_t seed = 1;

    /// @param reason  where not null: one sentence that says what is wrong
    bool isValid(std::string* reason = nullptr) const;
};

/// The excited lines, ascending, each within 1 .. (N-1)/2. They depend on the seed, not on the
/// realization, so that detection lines stay silent in all realizations.
/// Throws Error (usage) when the options are not valid or no line of the grid lies in the band.
std::vector<int> chooseLines(const MultisineOptions&);

/// The odd lines between the first and the last excited one that are silent: odd nonlinear
/// distortion shows there. (The even lines show the even distortion of any odd grid.)
std::vector<int> oddDetectionLines(const std::vector<int>& excited);

/// One period of the random-phase multisine
///     u(n) = sum_k a_k cos(2 pi k n / N + phi_k),  n = 0 .. N-1,  sum_k a_k^2 / 2 = rms^2,
/// phi_k uniform on [0, 2 pi), drawn anew for each realization (0, 1, ...). Its mean is zero. The
/// generator is std::mt19937_64 with a mapping of its own, so it draws the same phases everywhere.
/// Throws Error (usage) when the options are not valid or a line is not within 1 .. (N-1)/2.
std::vector<double> multisine(const MultisineOptions&, const std::vector<int>& lines, int realization);

}  // namespace excursion
