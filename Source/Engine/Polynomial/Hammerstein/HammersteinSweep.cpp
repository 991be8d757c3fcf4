// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Hammerstein/HammersteinSweep.h"

#include "Engine/Error.h"
#include "Engine/Polynomial/InputOutputRecord.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Validity.h"

#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>

namespace excursion {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

constexpr double turn = 2.0 * std::numbers::pi;

/// B_nm of sin^n, with the j of a cosine.
Complex multipleAngle(int n, int m)
{
    double binomial = 1.0;
    for (int k = 1; k <= (n - m) / 2; ++k)
        binomial *= static_cast<double>(n - k + 1) / k;
    const double B = std::ldexp(binomial, 1 - n) * (m / 2 % 2 == 0 ? 1.0 : -1.0);
    return n % 2 == 0 ? Complex(0.0, B) : Complex(B, 0.0);
}

/// x of T x = b, T_ij = r_|i-j| positive definite, by conjugate gradients with products by DFT. T is that of a band:
/// but for some log(length) of them its eigenvalues are near 1 or near the regularization (Slepian), so a few dozen
/// iterations do at any length, where Levinson's recursion loses all digits at some thousand.
std::vector<double> solvedToeplitz(const std::vector<double>& r, const std::vector<double>& b, std::size_t length)
{
    const auto L = quickLength(2 * length);
    std::vector<double> circle(L, 0.0);
    for (std::size_t k = 0; k < length; ++k)
        circle[k] = circle[(L - k) % L] = r[k];
    const auto C = fft(circle);
    const auto times = [&](std::vector<double> x) {
        x.resize(L, 0.0);
        auto X = fft(x);
        for (std::size_t k = 0; k < X.size(); ++k)
            X[k] *= C[k].real();
        auto y = inverseFft(X, L);
        y.resize(length);
        return y;
    };
    const auto dot = [](const std::vector<double>& a, const std::vector<double>& c) {
        return std::inner_product(a.begin(), a.end(), c.begin(), 0.0);
    };
    std::vector<double> x(length, 0.0), left(b.begin(), b.begin() + static_cast<std::ptrdiff_t>(length));
    auto direction = left;
    double squares = dot(left, left);
    const double enough = 1e-24 * squares;
    for (int iteration = 0; iteration < 1000 && squares > enough; ++iteration) {
        const auto ahead = times(direction);
        const double step = squares / dot(direction, ahead);
        for (std::size_t k = 0; k < length; ++k) {
            x[k] += step * direction[k];
            left[k] -= step * ahead[k];
        }
        const double next = dot(left, left);
        for (std::size_t k = 0; k < length; ++k)
            direction[k] = left[k] + next / squares * direction[k];
        squares = next;
    }
    return x;
}

/// The taps of least squares on lines where `known`, of an even grid of 0 .. fs/2: normal equations that are Toeplitz
/// and made by DFT.
Eigen::VectorXd fittedTaps(const Eigen::VectorXcd& response, const std::vector<bool>& known, Index length,
                           double regularization)
{
    std::vector<Complex> mask(known.size()), masked(known.size());
    for (std::size_t k = 0; k < known.size(); ++k)
        if (known[k]) {
            mask[k] = 1.0;
            masked[k] = response[static_cast<Index>(k)];
        }
    const auto P = 2 * (known.size() - 1);
    auto r = inverseFft(mask, P);
    r[0] *= 1.0 + regularization;
    const auto taps = solvedToeplitz(r, inverseFft(masked, P), static_cast<std::size_t>(length));
    return Eigen::Map<const Eigen::VectorXd>(taps.data(), length);
}

}  // namespace

SweepBand knownBand(const ExponentialSweep& sweep, const HammersteinSweepOptions& options)
{
    const auto& band = sweep.options();
    const double lasted = band.fadeOut + 2.0 * options.edge + static_cast<double>(options.length) / band.sampleRate;
    return {band.bandLow * std::exp(band.fadeIn / sweep.rate()), band.bandHigh * std::exp(-lasted / sweep.rate())};
}

double sweepWindow(std::size_t at, std::size_t length, std::size_t edge)
{
    const auto inside = std::min(at, length - 1 - at);
    if (inside >= edge)
        return 1.0;
    return 0.5 - 0.5 * std::cos(std::numbers::pi * (static_cast<double>(inside) + 0.5) / static_cast<double>(edge));
}

bool HammersteinSweepOptions::isValid(std::string* reason) const
{
    if (degree < 1 || degree > 20)
        return refuse(reason, "the degree of a parallel Hammerstein model must be 1 to 20");
    if (length < 1 || length > 65536)
        return refuse(reason, "the branches of a parallel Hammerstein model have 1 to 65536 taps");
    if (!(edge > 0.0 && edge <= 1.0))
        return refuse(reason, "the edge that is kept around a response must be above 0 s and at most 1 s");
    if (!(regularization > 0.0 && regularization < 1.0))
        return refuse(reason, "the regularization must lie between 0 and 1");
    return true;
}

HarmonicResponses harmonicResponses(const ExponentialSweep& sweep, std::span<const double> output,
                                    const HammersteinSweepOptions& options)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "The answer to the sweep cannot be taken apart: " + reason + ".");
    const double rate = sweep.options().sampleRate;
    const auto played = static_cast<std::size_t>(std::ceil(sweep.seconds() * rate));
    if (output.size() < played)
        throw Error(Error::Kind::data, "The answer to the sweep has " + std::to_string(output.size())
                                           + " samples, fewer than the " + std::to_string(played) + " of the sweep.");
    for (const double y : output)
        if (!std::isfinite(y))
            throw Error(Error::Kind::data, "The answer to the sweep holds a sample that is not finite.");
    const int N = options.degree;
    HarmonicResponses result;
    result.sampleRate = rate;
    result.separation = sweep.rate() * (N > 1 ? std::log(static_cast<double>(N) / (N - 1)) : std::numbers::ln2);
    const auto edge = static_cast<std::size_t>(std::ceil(options.edge * rate));
    const auto kept = static_cast<std::size_t>(options.length) + 2 * edge;
    if (static_cast<double>(kept) > result.separation * rate)
        throw Error(Error::Kind::data,
                    "The harmonics overlap: they come " + std::to_string(result.separation)
                        + " s apart, less than their responses are to last; let the sweep last longer, "
                          "or ask for fewer taps.");

    // Long enough that what comes ahead of time, by up to the length of the sweep, does not meet what comes late.
    const auto length = std::bit_ceil(output.size() + played + kept);
    std::vector<double> y(output.begin(), output.end());
    y.resize(length);
    auto H = fft(y);
    H[0] = 0.0;
    const double step = rate / static_cast<double>(length);
    for (std::size_t k = 1; k < H.size(); ++k)
        H[k] /= rate * sweep.spectrum(step * static_cast<double>(k));

    const auto grid = std::bit_ceil(2 * kept);
    for (std::size_t k = 0; k <= grid / 2; ++k)
        result.frequency.push_back(rate * static_cast<double>(k) / static_cast<double>(grid));
    result.value.resize(static_cast<Index>(grid / 2 + 1), N);
    const auto h = inverseFft(H, length);
    for (int m = 1; m <= N; ++m) {
        // Its response to sample `edge`: whole samples are moved here, the part of one in the spectrum.
        const double later = static_cast<double>(edge) + sweep.advance(m) * rate, whole = std::floor(later);
        const auto from = (length - static_cast<std::size_t>(whole) % length) % length;
        std::vector<double> part(grid, 0.0);
        for (std::size_t n = 0; n < kept; ++n)
            part[n] = sweepWindow(n, kept, edge) * h[(from + n) % length];
        const auto spectrum = fft(part);
        for (std::size_t k = 0; k < spectrum.size(); ++k)
            result.value(static_cast<Index>(k),
                         m - 1) = spectrum[k]
                                  * std::polar(1.0, turn * static_cast<double>(k) / static_cast<double>(grid)
                                                        * (static_cast<double>(edge) - (later - whole)));
    }
    return result;
}

Eigen::MatrixXcd branchResponses(const HarmonicResponses& harmonics, double peak)
{
    const auto N = static_cast<int>(harmonics.value.cols());
    Eigen::MatrixXcd G = harmonics.value;
    for (int m = N; m >= 1; --m) {
        for (int n = m + 2; n <= N; n += 2)
            G.col(m - 1) -= multipleAngle(n, m) * std::pow(peak, n - 1) * G.col(n - 1);
        G.col(m - 1) /= multipleAngle(m, m) * std::pow(peak, m - 1);
    }
    return G;
}

HammersteinSweepFit identifyHammerstein(const ExponentialSweep& sweep, std::span<const double> output,
                                        const HammersteinSweepOptions& options)
{
    const auto harmonics = harmonicResponses(sweep, output, options);
    const auto& band = sweep.options();
    const int N = options.degree;
    const auto [unfaded, high] = knownBand(sweep, options);
    const double resolution = 1.0 / options.edge;
    if (N * unfaded + 2.0 * resolution >= high)
        throw Error(Error::Kind::usage,
                    "The sweep is too narrow for its degree, or too short: where it and its harmonics are all known "
                    "there is no band left.");
    const auto G = branchResponses(harmonics, band.peak);
    HammersteinSweepFit result;
    result.model.sampleRate = harmonics.sampleRate;
    result.model.filters.resize(options.length, N);
    for (int n = 1; n <= N; ++n) {
        const int last = N - (N - n) % 2;
        std::vector<bool> known;
        for (const double f : harmonics.frequency)
            known.push_back(f >= last * unfaded + resolution && f <= n * high - resolution);
        result.model.filters.col(n - 1) = fittedTaps(G.col(n - 1), known, options.length, options.regularization);
    }
    if (!result.model.filters.allFinite())
        throw Error(Error::Kind::numerical,
                    "The branch filters left the finite numbers; a larger regularization may help.");

    const auto x = sweep.samples();
    const auto samples = static_cast<Index>(x.size());
    const auto timeOf = [&](double f) {
        return static_cast<Index>(sweep.rate() * std::log(f / band.bandLow) * harmonics.sampleRate);
    };
    const Index from = timeOf(N * unfaded + resolution), to = timeOf(high - resolution);
    const auto centred = [&](const Eigen::MatrixXd& v) -> Eigen::MatrixXd {
        const Eigen::MatrixXd part = v.middleRows(from, to - from);
        return part.array() - part.mean();
    };
    InputOutputRecord record;
    record.output = centred(Eigen::Map<const Eigen::VectorXd>(output.data(), samples));
    result.estimationDb = outputErrorDb(
        {centred(simulate(result.model, Eigen::Map<const Eigen::VectorXd>(x.data(), samples)))}, {record});
    return result;
}

}  // namespace excursion
