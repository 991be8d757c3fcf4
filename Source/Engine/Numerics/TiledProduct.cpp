// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/TiledProduct.h"

#include "Engine/Numerics/Lanes.h"

#include <algorithm>

namespace excursion {
namespace {

// whose sums, eight registers, hide the latency of a sum and leave registers for the rest
constexpr int mostEights = 4;

/// A tile of `eights`; as few rows have sums enough when the columns are dealt to `ways` sums a row.
template <int eights, int ways>
[[gnu::always_inline]] inline void addTile(const double* W, int columns, const double* x, double* y)
{
    constexpr int fours = 2 * eights;
    Four sum[ways][fours];
    for (int p = 0; p < fours; ++p) {
        sum[0][p] = reinterpret_cast<const Four*>(y)[p];
        for (int way = 1; way < ways; ++way)
            sum[way][p] = Four {0.0, 0.0, 0.0, 0.0};
    }
    int column = 0;
    for (; column + ways <= columns; column += ways)
        for (int way = 0; way < ways; ++way, W += 4 * fours)
            for (int p = 0; p < fours; ++p)
                sum[way][p] += x[column + way] * reinterpret_cast<const Four*>(W)[p];
    for (; column < columns; ++column, W += 4 * fours)
        for (int p = 0; p < fours; ++p)
            sum[0][p] += x[column] * reinterpret_cast<const Four*>(W)[p];
    for (int p = 0; p < fours; ++p) {
        for (int way = 1; way < ways; ++way)
            sum[0][p] += sum[way][p];
        reinterpret_cast<Four*>(y)[p] = sum[0][p];
    }
}

EXCURSION_DISPATCH void add(const TiledProduct::Tile* tile, const TiledProduct::Tile* end, const double* W,
                            const double* x, double* y)
{
    for (; tile != end; ++tile) {
        switch (tile->eights) {
        case 1: addTile<1, 4>(W, tile->columns, x, y); break;
        case 2: addTile<2, 2>(W, tile->columns, x, y); break;
        case 3: addTile<3, 1>(W, tile->columns, x, y); break;
        default: addTile<4, 1>(W, tile->columns, x, y); break;
        }
        W += 8 * tile->eights * tile->columns;
        y += 8 * tile->eights;
    }
}

}  // namespace

TiledProduct::TiledProduct(const Eigen::MatrixXd& W) : rows_((W.rows() + 7) / 8 * 8)
{
    Eigen::MatrixXd padded = Eigen::MatrixXd::Zero(rows_, W.cols());
    padded.topRows(W.rows()) = W;
    for (Eigen::Index row = 0; row < rows_;) {
        const auto eights = std::min<Eigen::Index>(mostEights, (rows_ - row) / 8);
        const auto tile = padded.middleRows(row, 8 * eights);
        auto columns = tile.cols();
        while (columns > 0 && tile.col(columns - 1).isZero(0.0))
            --columns;
        tiles_.push_back({static_cast<int>(eights), static_cast<int>(columns)});
        for (Eigen::Index column = 0; column < columns; ++column)
            for (Eigen::Index eight = 0; eight < eights; ++eight)
                Eigen::Map<Eigen::Matrix<double, 8, 1>>(values_.emplace_back().value) = tile.col(column).segment<8>(
                    8 * eight);
        row += 8 * eights;
    }
}

void TiledProduct::addTo(double* y, const double* x) const
{
    add(tiles_.data(), tiles_.data() + tiles_.size(), values_.empty() ? nullptr : values_.front().value, x, y);
}

}  // namespace excursion
