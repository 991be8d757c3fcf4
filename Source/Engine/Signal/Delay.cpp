// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Signal/Delay.h"

#include "Engine/Error.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace excursion {
namespace {

using Complex = std::complex<double>;
constexpr double tau = 2 * std::numbers::pi;

/// Averages over segments: S_yu = E[Y conj(U)] and S_uu = E|U|^2, lines 0 .. N/2.
struct CrossSpectrum {
    std::size_t N = 0;
    std::vector<Complex> yu;
    std::vector<double> uu;
};

CrossSpectrum crossSpectrum(std::span<const double> input, std::span<const double> output, const DelayOptions& options)
{
    const bool periodic = options.period > 0;
    CrossSpectrum S;
    S.N = static_cast<std::size_t>(periodic ? options.period : std::max(options.segment, 16));
    if (!periodic)
        S.N = std::min(S.N, input.size());
    if (input.size() < S.N)
        throw Error(Error::Kind::data, "A delay can only be estimated from at least one whole period.");
    S.yu.resize(S.N / 2 + 1);
    S.uu.resize(S.N / 2 + 1);
    // Whole periods have no leakage; anything else is tapered and overlapped by half.
    const std::size_t hop = periodic ? S.N : S.N / 2;
    std::vector<double> window(S.N, 1.0);
    if (!periodic)
        for (std::size_t n = 0; n < S.N; ++n)
            window[n] = 0.5 - 0.5 * std::cos(tau * static_cast<double>(n) / static_cast<double>(S.N));
    std::vector<double> u(S.N), y(S.N);
    for (std::size_t first = 0; first + S.N <= input.size(); first += hop) {
        for (std::size_t n = 0; n < S.N; ++n) {
            u[n] = window[n] * input[first + n];
            y[n] = window[n] * output[first + n];
        }
        const auto U = fft(u), Y = fft(y);
        for (std::size_t k = 0; k < U.size(); ++k) {
            S.yu[k] += Y[k] * std::conj(U[k]);
            S.uu[k] += std::norm(U[k]);
        }
    }
    return S;
}

/// Lines inside the band, without DC and Nyquist, whose phase means nothing for a delay.
std::pair<std::size_t, std::size_t> bandLines(std::size_t N, const DelayOptions& options)
{
    const auto n = static_cast<double>(N);
    const auto first = static_cast<std::size_t>(std::max(1.0, std::ceil(options.lowest * n)));
    const auto last = static_cast<std::size_t>(std::min(std::floor(options.highest * n), std::floor((n - 1) / 2)));
    return {first, last};
}

double coarseDelay(const CrossSpectrum& S, std::size_t first, std::size_t last)
{
    // The real and the imaginary part of the analytic impulse response, as two real records.
    const double floor = *std::max_element(S.uu.begin(), S.uu.end()) / 1e3;  // keeps unexcited lines out
    std::vector<Complex> H(S.yu.size()), rotated(S.yu.size());
    for (std::size_t k = first; k <= last; ++k) {
        H[k] = S.yu[k] / (S.uu[k] + floor);
        rotated[k] = H[k] * Complex(0, -1);
    }
    const auto real = inverseFft(H, S.N), imaginary = inverseFft(rotated, S.N);
    const auto magnitude = [&](std::size_t n) { return std::hypot(real[n], imaginary[n]); };
    std::size_t peak = 0;
    for (std::size_t n = 1; n < S.N; ++n)
        if (magnitude(n) > magnitude(peak))
            peak = n;
    // With odd lines only, half a period later is the same as inverted; the shorter of the two is meant.
    const std::size_t opposite = (peak + S.N / 2) % S.N;
    const auto centred = [&](std::size_t n) {
        return static_cast<double>(n) - (n > S.N / 2 ? static_cast<double>(S.N) : 0.0);
    };
    const bool ambiguous = magnitude(opposite) > 0.9 * magnitude(peak);
    return ambiguous && std::abs(centred(opposite)) < std::abs(centred(peak)) ? centred(opposite) : centred(peak);
}

}  // namespace

std::vector<double> delayed(std::span<const double> x, double samples)
{
    const std::size_t N = x.size();
    auto X = fft(x);
    for (std::size_t k = 0; k < X.size(); ++k) {
        const double angle = -tau * static_cast<double>(k) / static_cast<double>(N) * samples;
        X[k] *= 2 * k == N ? Complex(std::cos(angle), 0) : std::polar(1.0, angle);
    }
    return N == 0 ? std::vector<double> {} : inverseFft(X, N);
}

DelayEstimate estimateDelay(std::span<const double> input, std::span<const double> output, const DelayOptions& options)
{
    if (input.size() != output.size() || input.size() < 16)
        throw Error(Error::Kind::data,
                    "A delay can only be estimated between two records of the same length, at least 16 samples.");
    const auto S = crossSpectrum(input, output, options);
    const auto [first, last] = bandLines(S.N, options);
    double power = 0.0, weights = 0.0;
    std::vector<double> weight(S.yu.size());
    for (std::size_t k = first; k <= last; ++k) {
        power = std::max(power, S.uu[k]);
        weight[k] = S.uu[k] > 0 ? std::norm(S.yu[k]) / S.uu[k] : 0.0;
        weights += weight[k];
    }
    if (!(weights > 0) || !std::isfinite(weights))
        throw Error(Error::Kind::data, "A delay cannot be estimated: one of the records is silent in the band.");
    for (std::size_t k = first; k <= last; ++k)
        if (S.uu[k] < 1e-12 * power)  // rounding noise has no phase worth a weight
            weight[k] = 0.0;

    DelayEstimate estimate;
    estimate.samples = coarseDelay(S, first, last);
    const auto omega = [&](std::size_t k) { return tau * static_cast<double>(k) / static_cast<double>(S.N); };
    const auto aligned = [&](std::size_t k) {
        const auto c = S.yu[k] * std::polar(1.0, omega(k) * estimate.samples);
        return estimate.inverted ? -c : c;
    };
    double inPhase = 0.0;
    for (std::size_t k = first; k <= last; ++k)
        inPhase += weight[k] > 0 ? weight[k] * aligned(k).real() / std::abs(S.yu[k]) : 0.0;
    estimate.inverted = inPhase < 0;

    // The coarse delay is at most half a sample off, so no phase wraps; the second pass takes care of
    // lines that did because they are noisy.
    for (int pass = 0; pass < 4; ++pass) {
        double slope = 0.0, curvature = 0.0;
        for (std::size_t k = first; k <= last; ++k)
            if (weight[k] > 0) {
                slope += weight[k] * omega(k) * std::arg(aligned(k));
                curvature += weight[k] * omega(k) * omega(k);
            }
        estimate.samples -= slope / curvature;
        double scatter = 0.0, count = 0.0;
        for (std::size_t k = first; k <= last; ++k)
            if (weight[k] > 0) {
                scatter += weight[k] * std::pow(std::arg(aligned(k)), 2);
                count += 1.0;
            }
        estimate.standardError = count > 1 ? std::sqrt(scatter / (count - 1) / curvature) : 0.0;
    }
    return estimate;
}

}  // namespace excursion
