// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Resampling.h"

#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace excursion::bench {

std::size_t smoothLength(std::size_t n)
{
    for (std::size_t length = n + n % 2;; length += 2) {
        std::size_t rest = length;
        for (const std::size_t prime : {2u, 3u, 5u})
            while (rest % prime == 0)
                rest /= prime;
        if (rest == 1)
            return length;
    }
}

std::vector<double> interpolate(std::span<const double> x, int factor, double offset)
{
    const auto M = smoothLength(x.size()), N = M * static_cast<std::size_t>(factor);
    std::vector<double> padded(x.begin(), x.end());
    padded.resize(M);
    auto spectrum = fft(padded);
    spectrum.back() = 0.0;
    spectrum.resize(N / 2 + 1);
    for (std::size_t k = 0; k < M / 2; ++k)
        spectrum[k] *= std::polar(static_cast<double>(factor),
                                  2.0 * std::numbers::pi * static_cast<double>(k) * offset / static_cast<double>(N));
    auto y = inverseFft(spectrum, N);
    y.resize(x.size() * static_cast<std::size_t>(factor));
    return y;
}

std::vector<double> decimate(std::span<const double> x, int factor, std::size_t length)
{
    constexpr std::size_t silence = 512;
    const auto fine = static_cast<std::size_t>(factor);
    const auto M = smoothLength(std::max(length, x.size() / fine + 1) + silence), N = M * fine;
    std::vector<double> padded(x.begin(), x.end());
    padded.resize(N);
    auto spectrum = fft(padded);
    spectrum.resize(M / 2 + 1);
    for (std::size_t k = 0; k <= M / 2; ++k) {
        const double f = static_cast<double>(k) / static_cast<double>(M);
        const double pass = k == M / 2 ? 0.0 : 0.5 * std::erfc((f - 0.46) / 0.0095);
        spectrum[k] *= pass / factor;
    }
    auto y = inverseFft(spectrum, M);
    y.resize(length);
    return y;
}

double readBetween(std::span<const double> x, double p)
{
    constexpr int count = 12;
    static const auto denominators = [] {
        std::array<double, count> below {};
        for (int n = 0; n < count; ++n) {
            below[n] = 1.0;
            for (int m = 0; m < count; ++m)
                if (m != n)
                    below[n] /= n - m;
        }
        return below;
    }();

    constexpr int half = count / 2;
    const double whole = std::floor(p), t = p - whole + half - 1;  // t from the first of the 12
    const long first = static_cast<long>(whole) - (half - 1);
    // Products of (t - m) over m < n and m > n
    std::array<double, count> left {}, right {};
    left[0] = right[count - 1] = 1.0;
    for (int n = 1; n < count; ++n) {
        left[n] = left[n - 1] * (t - (n - 1));
        right[count - 1 - n] = right[count - n] * (t - (count - n));
    }
    double sum = 0.0;
    for (int n = 0; n < count; ++n) {
        const long at = first + n;
        if (at >= 0 && at < static_cast<long>(x.size()))
            sum += x[static_cast<std::size_t>(at)] * left[n] * right[n] * denominators[n];
    }
    return sum;
}

}  // namespace excursion::bench
