// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/Welch.h"

#include "Engine/Error.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion {
namespace {

std::vector<double> windowOf(const WelchOptions& options)
{
    const auto N = static_cast<std::size_t>(options.segment);
    std::vector<double> w(N, 1.0);
    if (options.hann)
        for (std::size_t n = 0; n < N; ++n)
            w[n] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(n) / static_cast<double>(N));
    return w;
}

std::vector<std::complex<double>> spectrumOf(std::span<const double> x, const std::vector<double>& window)
{
    double mean = 0.0;
    for (const double value : x)
        mean += value / static_cast<double>(x.size());
    std::vector<double> windowed(x.size());
    for (std::size_t n = 0; n < x.size(); ++n)
        windowed[n] = (x[n] - mean) * window[n];
    return fft(windowed);
}

/// Overlapping segments share samples: the variance of an average over S of them is 1/n with
/// 1/n = 1/S (1 + 2 sum_j (1 - j/S) rho_j^2), rho_j the window's correlation at a shift of j hops (Welch 1967).
double independentAverages(const std::vector<double>& window, std::size_t hop, int segments)
{
    double energy = 0.0;
    for (const double w : window)
        energy += w * w;
    double sum = 1.0;
    for (std::size_t j = 1; j * hop < window.size() && static_cast<int>(j) < segments; ++j) {
        double shared = 0.0;
        for (std::size_t n = 0; n + j * hop < window.size(); ++n)
            shared += window[n] * window[n + j * hop];
        sum += 2.0 * (1.0 - static_cast<double>(j) / segments) * (shared / energy) * (shared / energy);
    }
    return segments / sum;
}

}  // namespace

int segmentFor(std::size_t length, int count, int longest, int shortest)
{
    while (longest / 2 >= shortest && length < static_cast<std::size_t>(count) * static_cast<std::size_t>(longest))
        longest /= 2;
    return longest;
}

int WelchOptions::segmentOf(std::size_t length) const { return segment == 0 ? segmentFor(length, 4) : segment; }

bool WelchOptions::isValid(std::size_t length, std::string* reason) const
{
    const int N = segmentOf(length);
    if (N < 16)
        return refuse(reason, "A segment needs at least 16 samples, not " + std::to_string(N) + ".");
    if (!(overlap >= 0.0 && overlap <= 0.9))
        return refuse(reason, "The overlap must lie in 0 .. 0.9.");
    if (length < 2 * static_cast<std::size_t>(N))
        return refuse(reason, "The record has " + std::to_string(length) + " samples, fewer than two segments of "
                                  + std::to_string(N) + "; choose a shorter segment.");
    return true;
}

WelchResult welch(std::span<const double> input, std::span<const double> output, double sampleRate,
                  const WelchOptions& given)
{
    if (input.size() != output.size())
        throw Error(Error::Kind::data, "The input and the output channel differ in length.");
    if (std::string reason; !given.isValid(input.size(), &reason))
        throw Error(Error::Kind::usage, reason);
    auto options = given;
    options.segment = given.segmentOf(input.size());

    const auto N = static_cast<std::size_t>(options.segment);
    const auto hop = std::max<std::size_t>(
        1, static_cast<std::size_t>(std::lround((1.0 - options.overlap) * options.segment)));
    const auto window = windowOf(options);
    const std::size_t F = N / 2 - 1;
    std::vector<double> Suu(F, 0.0), Syy(F, 0.0);
    std::vector<std::complex<double>> Syu(F, 0.0);
    WelchResult result;
    for (std::size_t start = 0; start + N <= input.size(); start += hop, ++result.segments) {
        const auto U = spectrumOf(input.subspan(start, N), window);
        const auto Y = spectrumOf(output.subspan(start, N), window);
        for (std::size_t i = 0; i < F; ++i) {
            Suu[i] += std::norm(U[i + 1]);
            Syy[i] += std::norm(Y[i + 1]);
            Syu[i] += Y[i + 1] * std::conj(U[i + 1]);
        }
    }

    double energy = 0.0;
    for (const double w : window)
        energy += w * w;
    const double n = result.effectiveAverages = independentAverages(window, hop, result.segments);
    const double density = 2.0 / (result.segments * sampleRate * energy);
    for (std::size_t i = 0; i < F; ++i) {
        const double product = Suu[i] * Syy[i];
        const double coherence = product > 0.0 ? std::min(1.0, std::norm(Syu[i]) / product) : 0.0;
        const auto G = Suu[i] > 0.0 ? Syu[i] / Suu[i] : std::complex<double>(0.0);
        result.frf.frequency.push_back(static_cast<double>(i + 1) * sampleRate / static_cast<double>(N));
        result.frf.value.push_back(G);
        // |G|^2 (1 - g) / g without the 0/0 of a coherence of zero
        result.frf.noiseVariance.push_back(Suu[i] > 0.0 ? (1.0 - coherence) * Syy[i] / Suu[i] / n : 0.0);
        result.coherence.push_back(coherence);
        result.inputPower.push_back(Suu[i] * density);
        result.outputPower.push_back(Syy[i] * density);
        result.nonCoherentPower.push_back((1.0 - coherence) * Syy[i] * density * n / std::max(n - 1.0, 0.5));
    }
    return result;
}

WelchResult welch(const Measurement& take, Quantity output, const WelchOptions& options)
{
    return welch(take.input().samples, take.channel(output).samples, take.sampleRate, options);
}

}  // namespace excursion
