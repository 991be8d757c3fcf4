// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/HalfBand.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion {
namespace {

/// Two-sided: h_-reach .. h_reach at odd places, scaled.
std::vector<double> mirrored(const HalfBandTaps& half, double scale)
{
    std::vector<double> both;
    for (auto tap = half.side.rbegin(); tap != half.side.rend(); ++tap)
        both.push_back(scale * *tap);
    for (const double tap : half.side)
        both.push_back(scale * tap);
    return both;
}

/// out[j] = sum_k taps[k] x[j + k] for j = 0 .. n-1 (the taps are symmetric). Four outputs at a time, so that the sums
/// need not wait for one another; each of them adds in the same order at whatever place of a block it stands.
void convolve(const std::vector<double>& taps, const double* x, std::size_t n, double* out, std::size_t stride)
{
    const std::size_t count = taps.size();
    std::size_t j = 0;
    for (; j + 4 <= n; j += 4) {
        double sum[4] = {0.0, 0.0, 0.0, 0.0};
        for (std::size_t k = 0; k < count; ++k)
            for (std::size_t lane = 0; lane < 4; ++lane)
                sum[lane] += taps[k] * x[j + k + lane];
        for (std::size_t lane = 0; lane < 4; ++lane)
            out[(j + lane) * stride] = sum[lane];
    }
    for (; j < n; ++j) {
        double sum = 0.0;
        for (std::size_t k = 0; k < count; ++k)
            sum += taps[k] * x[j + k];
        out[j * stride] = sum;
    }
}

}  // namespace

HalfBandTaps::HalfBandTaps(double width, double attenuation)
{
    const double beta = 0.1102 * (attenuation - 8.7);
    const double order = (attenuation - 7.95) / (2.285 * 2.0 * std::numbers::pi * width);
    const int pairs = std::max(1, static_cast<int>(std::ceil((0.5 * order + 1.0) / 2.0)));
    const int last = 2 * pairs - 1;
    const double whole = std::cyl_bessel_i(0.0, beta);
    double sum = 0.0;
    for (int k = 1; k <= last; k += 2) {
        const double place = static_cast<double>(k) / (last + 1);
        const double window = std::cyl_bessel_i(0.0, beta * std::sqrt(1.0 - place * place)) / whole;
        side.push_back(std::sin(0.5 * std::numbers::pi * k) / (std::numbers::pi * k) * window);
        sum += side.back();
    }
    for (auto& tap : side)
        tap *= 0.25 / sum;  // exactly 1 at 0 Hz
}

Doubler::Doubler(const HalfBandTaps& half, std::size_t longestBlock)
    : taps_(mirrored(half, 2.0)), history_(taps_.size() - 1 + longestBlock, 0.0)
{
}

void Doubler::reset() { std::fill(history_.begin(), history_.end(), 0.0); }

void Doubler::process(const double* in, std::size_t n, double* out)
{
    // y[m] belongs to the time m - reach. Odd m meet the centre tap and copy an input, even m the odd places.
    const std::size_t past = taps_.size() - 1;
    std::copy(in, in + n, history_.begin() + static_cast<std::ptrdiff_t>(past));
    convolve(taps_, history_.data(), n, out, 2);
    const std::size_t behind = (past - 1) / 2;  // (reach - 1) / 2
    for (std::size_t j = 0; j < n; ++j)
        out[2 * j + 1] = history_[past + j - behind];
    std::copy(history_.begin() + static_cast<std::ptrdiff_t>(n),
              history_.begin() + static_cast<std::ptrdiff_t>(n + past), history_.begin());
}

Halver::Halver(const HalfBandTaps& half, std::size_t longestBlock)
    : taps_(mirrored(half, 1.0)), even_(taps_.size() - 1 + longestBlock, 0.0), odd_(even_)
{
}

void Halver::reset()
{
    std::fill(even_.begin(), even_.end(), 0.0);
    std::fill(odd_.begin(), odd_.end(), 0.0);
}

void Halver::process(const double* in, std::size_t n, double* out)
{
    // z[j] = h_0 y[2j - reach] + sum over odd k of h_k y[2j - reach - k]: the first falls on odd, the others on even
    // inputs.
    const std::size_t past = taps_.size() - 1;
    for (std::size_t j = 0; j < n; ++j) {
        even_[past + j] = in[2 * j];
        odd_[past + j] = in[2 * j + 1];
    }
    convolve(taps_, even_.data(), n, out, 1);
    const std::size_t behind = (past + 1) / 2;  // (reach + 1) / 2
    for (std::size_t j = 0; j < n; ++j)
        out[j] += 0.5 * odd_[past + j - behind];
    for (auto* phase : {&even_, &odd_})
        std::copy(phase->begin() + static_cast<std::ptrdiff_t>(n),
                  phase->begin() + static_cast<std::ptrdiff_t>(n + past), phase->begin());
}

}  // namespace excursion
