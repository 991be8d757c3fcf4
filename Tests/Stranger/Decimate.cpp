// SPDX-License-Identifier: GPL-3.0-or-later
#include "Decimate.h"
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace sim {

static double bessel0(double z)
{
    double sum = 1, term = 1;
    for (int k = 1; k < 60; ++k) {
        term *= (z / 2 / k) * (z / 2 / k);
        sum += term;
    }
    return sum;
}

std::vector<double> decimate(const std::vector<double>& fine, int factor)
{
    if (factor == 1)
        return fine;
    // Kaiser window for -130 dB: pass to 0.44, stop from 0.56 of the output's rate.
    const int half = 36 * factor;
    const double beta = 0.1102 * (130 - 8.7);
    std::vector<double> taps(std::size_t(2 * half + 1));
    double sum = 0;
    for (int k = -half; k <= half; ++k) {
        double z = double(k) / factor, w = double(k) / half;
        double tap = (k == 0 ? 1 : std::sin(M_PI * z) / (M_PI * z)) * bessel0(beta * std::sqrt(1 - w * w));
        taps[std::size_t(k + half)] = tap;
        sum += tap;
    }
    for (double& tap : taps)
        tap /= sum;
    const std::ptrdiff_t size = std::ptrdiff_t(fine.size());
    std::vector<double> out(fine.size() / std::size_t(factor));
    for (std::size_t s = 0; s < out.size(); ++s) {
        const std::ptrdiff_t middle = std::ptrdiff_t(s) * factor;
        const std::ptrdiff_t from = std::max<std::ptrdiff_t>(0, middle - half), to = std::min(size - 1, middle + half);
        double value = 0;
        for (std::ptrdiff_t k = from; k <= to; ++k)
            value += fine[std::size_t(k)] * taps[std::size_t(k - middle + half)];
        out[s] = value;
    }
    return out;
}

// Lagrange through six points; the fine grid is far above the band, so this is exact for our purpose.
static double between(const std::vector<double>& y, double at)
{
    const std::ptrdiff_t k = std::ptrdiff_t(std::floor(at));
    double f = at - double(k), sum = 0;
    for (int j = -2; j <= 3; ++j) {
        const std::ptrdiff_t place = k + j;
        if (place < 0 || place >= std::ptrdiff_t(y.size()))
            continue;
        double weight = 1;
        for (int l = -2; l <= 3; ++l)
            if (l != j)
                weight *= (f - l) / double(j - l);
        sum += weight * y[std::size_t(place)];
    }
    return sum;
}

std::vector<double> radiate(const std::vector<double>& cone, const std::vector<double>& port,
                            const std::vector<double>& x, double rate, double distance, bool doppler)
{
    constexpr double speed = 343.2, density = 1.2;
    const double gain = density / (2 * M_PI * distance), late = distance / speed * rate;
    std::vector<double> p(cone.size());
    for (std::size_t s = 0; s < p.size(); ++s) {
        double left = double(s) - late, from = left;
        if (left < -3)
            continue;
        if (doppler)
            for (int pass = 0; pass < 5; ++pass)
                from = left + between(x, from) / speed * rate;
        p[s] = gain * (between(cone, from) + between(port, left));
    }
    return p;
}

}  // namespace sim
