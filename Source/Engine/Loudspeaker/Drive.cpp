// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Drive.h"

#include "Engine/Signal/Resample.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace excursion {

Drive::Drive(std::span<const double> samples, double sampleRate, int substeps)
    : length_(samples.size()),
      substeps_(substeps),
      step_(1.0 / (sampleRate * substeps)),
      fine_(upsample(samples, 2 * substeps))
{
}

std::array<double, 7> Drive::polynomial(std::size_t halfStep) const
{
    // Lagrange's polynomial through s = -1, -1/2, ..., 2, by the inverse of its Vandermonde matrix.
    constexpr int count = 7;
    static const auto inverse = [] {
        Eigen::Matrix<double, count, count> vandermonde;
        for (int row = 0; row < count; ++row)
            for (int column = 0; column < count; ++column)
                vandermonde(row, column) = std::pow(0.5 * (row - 2), column);
        return vandermonde.inverse().eval();
    }();
    const auto last = static_cast<std::ptrdiff_t>(fine_.size()) - 1;
    Eigen::Matrix<double, count, 1> value;
    for (int k = 0; k < count; ++k) {
        const auto n = static_cast<std::ptrdiff_t>(halfStep) + k - 2;
        const auto inside = [&](std::ptrdiff_t at) {
            return fine_[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(at, 0, last))];
        };
        value[k] = n < 0      ? 2.0 * inside(0) - inside(-n)
                   : n > last ? 2.0 * inside(last) - inside(2 * last - n)
                              : inside(n);
    }
    std::array<double, count> result;
    Eigen::Map<Eigen::Matrix<double, count, 1>>(result.data()).noalias() = inverse * value;
    return result;
}

}  // namespace excursion
