// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/DrivenBand.h"

#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace excursion {

DrivenBand drivenBand(std::span<const double> input, double sampleRate)
{
    constexpr double seconds = 0.5, faint = 1e-5, bandsPerOctave = 3.0;
    const auto length = std::min(input.size(), static_cast<std::size_t>(std::max(seconds * sampleRate, 2048.0)));
    if (length < 64)
        return {};
    const double spacing = sampleRate / static_cast<double>(length);
    const auto bandOf = [&](std::size_t k) {
        return static_cast<std::size_t>(bandsPerOctave * std::log2(static_cast<double>(k)));
    };
    std::vector<double> power(bandOf(length / 2) + 1, 0.0);
    for (std::size_t begin = 0; begin + length <= input.size(); begin += length / 2) {
        std::vector<double> piece(input.begin() + static_cast<std::ptrdiff_t>(begin),
                                  input.begin() + static_cast<std::ptrdiff_t>(begin + length));
        double mean = 0.0;  // of an offset the window would make the lowest line
        for (const double value : piece)
            mean += value / static_cast<double>(length);
        for (std::size_t n = 0; n < length; ++n)
            piece[n] =
                (piece[n] - mean)
                * (0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(n) / static_cast<double>(length)));
        const auto spectrum = fft(piece);
        for (std::size_t k = 2; k < length / 2; ++k)
            power[bandOf(k)] += std::norm(spectrum[k]);
    }
    const double most = *std::max_element(power.begin(), power.end());
    if (!(most > 0.0))
        return {};
    const auto plays = [&](double one) { return one >= faint * most; };
    const auto first = std::find_if(power.begin(), power.end(), plays) - power.begin();
    const auto last = power.rend() - std::find_if(power.rbegin(), power.rend(), plays);  // one past it
    return {spacing * std::exp2(static_cast<double>(first) / bandsPerOctave),
            std::min(0.5 * sampleRate, spacing * std::exp2(static_cast<double>(last) / bandsPerOctave))};
}

}  // namespace excursion
