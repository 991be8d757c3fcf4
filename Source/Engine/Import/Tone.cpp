// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/Tone.h"

#include "Engine/Document/Figures.h"
#include "Engine/Error.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Level.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

namespace excursion {
namespace {

constexpr double frameSeconds = 0.05, partSeconds = 0.25, shortest = 0.5;  // s
constexpr double steadyDb = 0.5, noisiestDb = -20.0;
constexpr double steadyLevel = 0.02, steadyFrequency = 0.002;
constexpr double tau = 2 * std::numbers::pi;

struct Stretch {
    std::size_t begin = 0, end = 0;
};

/// The longest run of frames near the level of the loud ones.
Stretch steadyStretch(std::span<const double> x, std::size_t frame)
{
    std::vector<double> level;
    for (std::size_t n = 0; n + frame <= x.size(); n += frame)
        level.push_back(decibelsOf(rmsOf(x.subspan(n, frame)) * rmsOf(x.subspan(n, frame))));
    if (level.empty())
        return {};
    auto sorted = level;
    std::sort(sorted.begin(), sorted.end());
    const double loud = sorted[sorted.size() * 9 / 10];
    Stretch best;
    for (std::size_t k = 0; k < level.size();) {
        std::size_t end = k;
        std::vector<double> run;
        while (end < level.size() && std::abs(level[end] - loud) <= 3.0
               && (end == k || std::abs(level[end] - level[end - 1]) <= steadyDb))
            ++end;
        if (end - k > best.end - best.begin)
            best = {k, end};
        k = std::max(end, k + 1);
    }
    return best.end - best.begin < 3 ? Stretch {} : Stretch {(best.begin + 1) * frame, (best.end - 1) * frame};
}

struct Fit {
    std::complex<double> amplitude;  ///< of exp(j w n), n from the part's first sample
    double residual = 0.0;           ///< mean square
};

Fit fitSine(std::span<const double> x, double omega)
{
    Eigen::MatrixXd A(static_cast<Eigen::Index>(x.size()), 3);
    Eigen::VectorXd b(A.rows());
    for (Eigen::Index n = 0; n < A.rows(); ++n) {
        A(n, 0) = std::cos(omega * static_cast<double>(n));
        A(n, 1) = -std::sin(omega * static_cast<double>(n));
        A(n, 2) = 1.0;
        b(n) = x[static_cast<std::size_t>(n)];
    }
    const Eigen::Vector3d c = (A.transpose() * A).ldlt().solve(A.transpose() * b);
    return {{c(0), c(1)}, (A * c - b).squaredNorm() / static_cast<double>(x.size())};
}

/// Samples at an extreme, three or more equal ones in a row, of a tone whose fundamental goes beyond that extreme: its
/// tops are cut off. (A coarsely quantized top has as many, but is as high as the fundamental.)
long flattened(std::span<const double> x, double amplitude)
{
    const auto [low, high] = std::minmax_element(x.begin(), x.end());
    const double middle = (*low + *high) / 2;
    if (*high - middle > 0.997 * amplitude)
        return 0;
    long count = 0;
    for (std::size_t n = 0; n < x.size();) {
        auto end = n + 1;
        while (end < x.size() && x[end] == x[n])
            ++end;
        if (end - n >= 3 && (x[n] == *low || x[n] == *high))
            count += static_cast<long>(end - n);
        n = end;
    }
    return count;
}

/// The highest line of the windowed spectrum, refined by a parabola through its logarithms.
double coarseFrequency(std::span<const double> x)
{
    std::vector<double> windowed(x.begin(), x.end());
    double mean = 0.0;
    for (const double v : x)
        mean += v / static_cast<double>(x.size());
    for (std::size_t n = 0; n < x.size(); ++n)
        windowed[n] = (x[n] - mean)
                      * (0.5 - 0.5 * std::cos(tau * static_cast<double>(n) / static_cast<double>(x.size())));
    const auto X = fft(windowed);
    std::size_t peak = 1;
    for (std::size_t k = 1; k + 1 < X.size(); ++k)
        if (std::norm(X[k]) > std::norm(X[peak]))
            peak = k;
    const double a = std::log(std::norm(X[peak - 1]) + 1e-300), b = std::log(std::norm(X[peak]) + 1e-300),
                 c = std::log(std::norm(X[peak + 1]) + 1e-300);
    const double bend = a - 2 * b + c;
    return tau * (static_cast<double>(peak) + (bend < 0 ? 0.5 * (a - c) / bend : 0.0)) / static_cast<double>(x.size());
}

}  // namespace

Tone findTone(std::span<const double> samples, double sampleRate, const char* label)
{
    const auto refuse = [label](const std::string& why) {
        throw Error(Error::Kind::data, "The tone on " + std::string(label) + " cannot be used: " + why);
    };
    if (rmsOf(samples) < 1e-6)
        refuse("the channel is silent; check the cable and --channel.");
    const auto frame = static_cast<std::size_t>(std::max(16.0, std::round(frameSeconds * sampleRate)));
    const auto stretch = steadyStretch(samples, frame);
    const auto seconds = [&](std::size_t n) { return static_cast<double>(n) / sampleRate; };
    if (seconds(stretch.end - stretch.begin) < shortest)
        refuse("nowhere is its level steady for half a second; let the tone sound for a few seconds.");
    const auto x = samples.subspan(stretch.begin, stretch.end - stretch.begin);

    const auto length = std::min(x.size(), static_cast<std::size_t>(std::round(partSeconds * sampleRate)));
    const auto parts = x.size() / length;
    double omega = coarseFrequency(x);
    std::vector<Fit> fits;
    std::vector<double> turns;
    for (int pass = 0; pass < 3; ++pass) {
        fits.clear();
        turns.clear();
        for (std::size_t p = 0; p < parts; ++p)
            fits.push_back(fitSine(x.subspan(p * length, length), omega));
        double sum = 0.0;
        for (std::size_t p = 1; p < parts; ++p) {
            turns.push_back(std::arg(fits[p].amplitude * std::conj(fits[p - 1].amplitude)
                                     * std::polar(1.0, -omega * static_cast<double>(length))));
            sum += turns.back();
        }
        if (pass < 2 && parts > 1)
            omega += sum / static_cast<double>(parts - 1) / static_cast<double>(length);
    }

    double power = 0.0, residual = 0.0;
    std::vector<double> levels;
    for (const auto& fit : fits) {
        levels.push_back(std::abs(fit.amplitude) / std::numbers::sqrt2);
        power += std::norm(fit.amplitude) / 2 / static_cast<double>(parts);
        residual += fit.residual / static_cast<double>(parts);
    }
    Tone tone;
    tone.frequency = omega * sampleRate / tau;
    tone.rms = std::sqrt(power);
    tone.noiseDb = decibelsOf(residual / std::max(power, 1e-300));
    tone.begin = seconds(stretch.begin);
    tone.end = seconds(stretch.end);
    if (const auto flat = flattened(x, tone.rms * std::numbers::sqrt2); flat > 0)
        refuse(std::to_string(flat) + " samples stand at the converter's limit; lower the gain.");
    if (tone.noiseDb > noisiestDb)
        refuse("noise and distortion are only " + figure(-tone.noiseDb)
               + " dB below it; 20 dB are needed. Is anything else playing?");
    const auto [least, most] = std::minmax_element(levels.begin(), levels.end());
    if (*most - *least > steadyLevel * tone.rms)
        refuse("its level changes by " + figure(100 * (*most - *least) / tone.rms)
               + " % while it sounds; 2 % are allowed.");
    for (const double turn : turns)
        if (std::abs(turn) > steadyFrequency * omega * static_cast<double>(length))
            refuse("its frequency wanders by more than 0.2 %.");
    double scatter = 0.0;
    for (const double level : levels)
        scatter += (level - tone.rms) * (level - tone.rms);
    const auto count = static_cast<double>(parts);
    const double fromNoise = std::sqrt(residual / power / static_cast<double>(x.size()));
    const double fromParts = parts > 1 ? std::sqrt(scatter / (count - 1) / count) / tone.rms : 0.0;
    tone.relativeError = std::max(fromNoise, fromParts);
    return tone;
}

}  // namespace excursion
