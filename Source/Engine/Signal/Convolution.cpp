// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Signal/Convolution.h"

#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <bit>

namespace excursion {

std::vector<double> convolved(std::span<const double> w, std::span<const double> x)
{
    const auto N = x.size(), taps = std::min(w.size(), N);
    if (taps == 0)
        return std::vector<double>(N);
    const auto length = std::bit_ceil(N + taps);
    std::vector<double> a(w.begin(), w.begin() + static_cast<std::ptrdiff_t>(taps)), b(x.begin(), x.end());
    a.resize(length);
    b.resize(length);
    auto X = fft(a);
    const auto Y = fft(b);
    for (std::size_t k = 0; k < X.size(); ++k)
        X[k] *= Y[k];
    auto y = inverseFft(X, length);
    y.resize(N);
    return y;
}

}  // namespace excursion
