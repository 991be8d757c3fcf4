// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace excursion {

/// Discrete Fourier transform of a real record of any length N, by FFTW.
///     X_k = sum_n x_n exp(-2 pi j k n / N),  k = 0 .. N/2   (unnormalized, N/2 + 1 values)
/// A cosine of amplitude A on line k (0 < k < N/2) gives |X_k| = A N / 2.
std::vector<std::complex<double>> fft(std::span<const double> x);

/// The inverse: x_n = (1/N) sum_k X_k exp(+2 pi j k n / N), from the N/2 + 1 values of a real record.
/// @param X  the half spectrum
/// @param N  length of the record; X.size() must be N/2 + 1
std::vector<double> inverseFft(std::span<const std::complex<double>> X, std::size_t N);

/// The smallest number that is at least n, even, and has no prime factor above 5: a length that transforms quickly.
std::size_t quickLength(std::size_t n);

}  // namespace excursion
