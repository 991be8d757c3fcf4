// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/LaidRows.h"

#include "Engine/Numerics/Lanes.h"

#include <algorithm>

namespace excursion {
namespace {

constexpr std::size_t fours = 4, band = fours * lanes;  // rows whose sums stay in registers while their columns go by

template <std::size_t vectors>
[[gnu::always_inline]] inline void multiplyLaid(std::size_t rows, std::size_t columns, const std::size_t* filled,
                                                const double* laid, const double* x, double* y)
{
    for (std::size_t row = 0; row < rows; row += band, ++filled) {
        Four sums[vectors][fours] = {};
        for (std::size_t k = 0; k < *filled; ++k, laid += band) {
            const auto* const here = reinterpret_cast<const Four*>(laid);
            for (std::size_t v = 0; v < vectors; ++v)
                for (std::size_t f = 0; f < fours; ++f)
                    sums[v][f] += here[f] * x[v * columns + k];
        }
        for (std::size_t v = 0; v < vectors; ++v)
            for (std::size_t lane = 0; lane < std::min(band, rows - row); ++lane)
                y[v * rows + row + lane] = sums[v][lane / lanes][lane % lanes];
    }
}

EXCURSION_DISPATCH void multiplyOnce(std::size_t rows, std::size_t columns, const std::size_t* filled,
                                     const double* laid, const double* x, double* y)
{
    multiplyLaid<1>(rows, columns, filled, laid, x, y);
}

EXCURSION_DISPATCH void multiplyTwice(std::size_t rows, std::size_t columns, const std::size_t* filled,
                                      const double* laid, const double* x, double* y)
{
    multiplyLaid<2>(rows, columns, filled, laid, x, y);
}

}  // namespace

LaidRows::LaidRows(const Eigen::MatrixXd& H)
    : rows_(static_cast<std::size_t>(H.rows())), columns_(static_cast<std::size_t>(H.cols()))
{
    constexpr auto height = static_cast<Eigen::Index>(band);
    for (Eigen::Index row = 0; row < H.rows(); row += height) {
        const auto rows = H.middleRows(row, std::min(height, H.rows() - row));
        auto filled = H.cols();
        while (filled > 0 && rows.col(filled - 1).isZero(0.0))
            --filled;
        filled_.push_back(static_cast<std::size_t>(filled));
        for (Eigen::Index k = 0; k < filled; ++k)
            for (Eigen::Index lane = 0; lane < height; ++lane)
                laid_.push_back(lane < rows.rows() ? rows(lane, k) : 0.0);
    }
}

void LaidRows::multiply(const double* x, double* y) const
{
    multiplyOnce(rows_, columns_, filled_.data(), laid_.data(), x, y);
}

void LaidRows::multiplyFour(const double* X, double* Y) const
{
    // there are registers for two
    for (const std::size_t first : {0, 2})
        multiplyTwice(rows_, columns_, filled_.data(), laid_.data(), X + first * columns_, Y + first * rows_);
}

}  // namespace excursion
