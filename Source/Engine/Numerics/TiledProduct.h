// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include <vector>

namespace excursion {

/// y += W x of a fixed matrix with a few dozen rows, thousands of times a second. W is laid out once in the order in
/// which it is read: tiles of some rows, whose sums stay in registers, each without the columns at its right end that
/// are zero there. So whoever has blocks of zeros puts what leads to them last.
class TiledProduct {
public:
    struct Tile {
        int eights;  ///< rows / 8
        int columns;
    };

    TiledProduct() = default;
    explicit TiledProduct(const Eigen::MatrixXd& W);

    Eigen::Index rows() const { return rows_; }  ///< of y: those of W, padded

    void addTo(double* y, const double* x) const;

private:
    struct alignas(64) Eight {  ///< rows of one column: a line of the cache
        double value[8];
    };

    Eigen::Index rows_ = 0;
    std::vector<Tile> tiles_;
    std::vector<Eight> values_;  ///< tile by tile, by columns
};

}  // namespace excursion
