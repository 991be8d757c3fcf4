// SPDX-License-Identifier: GPL-3.0-or-later
// McKelvey's algorithm 1; see Subspace.h.
#include "Engine/Linear/Subspace.h"

#include "Engine/Error.h"
#include "Engine/Numerics/ThinSvd.h"
#include "Engine/Signal/Fft.h"

#include <cmath>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// The real part at line 0 from those of lines 1 .. 4 of an even function: cubic in k^2 through them.
double extrapolated(double g1, double g2, double g3, double g4)
{
    return (56.0 * g1 - 28.0 * g2 + 8.0 * g3 - g4) / 35.0;
}

[[noreturn]] void refuse(const std::string& why)
{
    throw Error(Error::Kind::data, "The frequency response does not lie on a uniform grid up to half the sample rate ("
                                       + why + "), which this algorithm needs; algorithm 2 takes any grid.");
}

}  // namespace

ObservabilityRange observabilityRangeUniform(const FrequencyData& data, double sampleRate, Index q)
{
    std::string reason;
    if (!data.isValid(&reason))
        throw Error(Error::Kind::data, "The frequency response cannot be identified: " + reason + ".");
    const auto K = data.lines(), p = data.outputs, m = data.inputs;
    if (K < 8)
        refuse("it has fewer than 8 lines");
    const double step = (data.frequency.back() - data.frequency.front()) / static_cast<double>(K - 1);
    const auto first = static_cast<Index>(std::lround(data.frequency.front() / step));
    const auto N = static_cast<Index>(std::lround(sampleRate / step));
    if (first > 1)
        refuse("its first line is line " + std::to_string(first));
    for (Index k = 0; k < K; ++k)
        if (std::abs(data.frequency[static_cast<std::size_t>(k)]
                     - static_cast<double>(first + k) * sampleRate / static_cast<double>(N))
            > 1e-6 * step)
            refuse("line " + std::to_string(k) + " is off the grid");
    const Index half = N / 2, last = first + K - 1;
    if (last > half || last < half - 1 || N % 2 != 0)
        refuse("its last line is line " + std::to_string(last) + " of " + std::to_string(half));
    q = std::min(q, half - 1);
    const Index r = std::min(q, N - q - 1);

    // Impulse responses h_1 .. and their block Hankel matrix q p x r m
    MatrixXd hankel(q * p, r * m);
    for (Index e = 0; e < p * m; ++e) {
        std::vector<std::complex<double>> spectrum(static_cast<std::size_t>(half) + 1);
        for (Index k = 0; k < K; ++k)
            spectrum[static_cast<std::size_t>(first + k)] = data.value(k, e);
        const auto re = [&spectrum](Index k) { return spectrum[static_cast<std::size_t>(k)].real(); };
        if (first == 1)
            spectrum[0] = extrapolated(re(1), re(2), re(3), re(4));
        if (last == half - 1)
            spectrum[static_cast<std::size_t>(half)] = extrapolated(re(half - 1), re(half - 2), re(half - 3),
                                                                    re(half - 4));
        const auto h = inverseFft(spectrum, static_cast<std::size_t>(N));
        const Index o = e % p, i = e / p;
        for (Index a = 0; a < q; ++a)
            for (Index b = 0; b < r; ++b)
                hankel(o + p * a, i + m * b) = h[static_cast<std::size_t>(a + b + 1)];
    }
    ObservabilityRange range;
    range.sampleRate = sampleRate;
    range.outputScale = Eigen::VectorXd::Ones(p);
    // The plain powers: z p_i = p_{i+1}
    range.H = MatrixXd::Zero(q + 1, q);
    range.H.diagonal(-1).setOnes();
    auto svd = leftSvd(hankel);
    range.U = std::move(svd.U);
    range.singularValues = svd.s / std::max(svd.s[0], 1e-300);
    return range;
}

}  // namespace excursion
