// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/LocalRational.h"

#include "Engine/Error.h"
#include "Engine/Numerics/LuFactors.h"
#include "Engine/Numerics/QrFactors.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>

namespace excursion {
namespace {

using Eigen::Index;

/// Of a real record, its spectrum at any line: conjugate below 0 and above half of the samples.
struct WholeSpectrum {
    std::vector<std::complex<double>> half;
    Index N;

    explicit WholeSpectrum(std::span<const double> x) : half(fft(x)), N(static_cast<Index>(x.size())) {}

    std::complex<double> at(Index line) const
    {
        line = ((line % N) + N) % N;
        return 2 * line <= N ? half[static_cast<std::size_t>(line)]
                             : std::conj(half[static_cast<std::size_t>(N - line)]);
    }
};

struct LocalValue {
    std::complex<double> value;
    double deviation;
};

constexpr Index localOrder = 2, localUnknowns = 3 * localOrder + 2;

LocalValue localValue(const WholeSpectrum& U, const WholeSpectrum& Y, Index line, Index reach)
{
    // [Re -Im; Im Re]: the real decompositions are compiled already.
    const Index rows = 2 * reach + 1;
    Eigen::MatrixXd M(2 * rows, 2 * localUnknowns);
    Eigen::VectorXd right(2 * rows);
    for (Index k = -reach; k <= reach; ++k) {
        const auto u = U.at(line + k), y = Y.at(line + k);
        const double r = static_cast<double>(k) / static_cast<double>(reach);
        const Index row = k + reach;
        const auto put = [&](Index column, std::complex<double> value) {
            M(row, column) = M(row + rows, column + localUnknowns) = value.real();
            M(row + rows, column) = value.imag();
            M(row, column + localUnknowns) = -value.imag();
        };
        for (Index p = 0; p <= localOrder; ++p) {
            put(p, std::pow(r, p) * u);
            put(localOrder + 1 + p, std::pow(r, p));
        }
        for (Index p = 1; p <= localOrder; ++p)
            put(2 * localOrder + 1 + p, -std::pow(r, p) * y);
        right[row] = y.real();
        right[row + rows] = y.imag();
    }
    const Eigen::VectorXd scale = M.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
    M *= scale.asDiagonal();
    const Eigen::VectorXd theta = pivotedSolveVector(M, right);
    const double left = (right - M * theta).squaredNorm() / static_cast<double>(rows - localUnknowns);
    // the first element of (M^H M)^-1, b0's share of the noise
    Eigen::MatrixXd gram = M.transpose() * M;
    gram.diagonal().array() += 1e-14;
    const double share = RealLu(gram).solve(Eigen::VectorXd::Unit(gram.rows(), 0))[0];
    return {std::complex(theta[0], theta[localUnknowns]) * scale[0], std::sqrt(std::max(0.0, left * share)) * scale[0]};
}

/// All lines as far as half of `most`, then ever wider apart.
std::vector<Index> chosenLines(Index last, Index most)
{
    std::vector<Index> lines;
    double growth = 1.0;
    if (last > most)
        growth = std::pow(2.0 * static_cast<double>(last) / static_cast<double>(most), 2.0 / static_cast<double>(most));
    for (double next = 1.0; next <= static_cast<double>(last);
         next = std::max(next + 1.0, next > 0.5 * static_cast<double>(most) ? next * growth : 0.0))
        lines.push_back(static_cast<Index>(next));
    return lines;
}

}  // namespace

FrequencyData localRationalResponse(std::span<const double> input, std::span<const double> output, double sampleRate,
                                    int most, int reach)
{
    if (input.size() != output.size() || input.size() < 64)
        throw Error(Error::Kind::data, "A response needs an input and an output of the same length, at least 64 "
                                       "samples; they have "
                                           + std::to_string(input.size()) + " and " + std::to_string(output.size())
                                           + ".");
    const WholeSpectrum U(input), Y(output);
    double largest = 0.0;
    for (const auto& u : U.half)
        largest = std::max(largest, std::abs(u));
    FrequencyData data;
    std::vector<LocalValue> values;
    for (const Index line : chosenLines((U.N - 1) / 2, most)) {
        double power = 0.0;
        for (Index k = -reach; k <= reach; ++k)
            power += std::norm(U.at(line + k));
        if (!(std::sqrt(power) > 1e-9 * largest))
            continue;
        const auto local = localValue(U, Y, line, reach);
        if (!std::isfinite(std::abs(local.value)) || !std::isfinite(local.deviation))
            continue;
        data.frequency.push_back(static_cast<double>(line) * sampleRate / static_cast<double>(U.N));
        values.push_back(local);
    }
    if (values.empty())
        throw Error(Error::Kind::data, "The input of the record is zero, so it has no frequency response.");
    const auto K = static_cast<Index>(values.size());
    data.value.resize(K, 1);
    data.deviation.resize(K, 1);
    double least = 0.0;
    for (const auto& local : values)
        if (local.deviation > 0.0 && (least == 0.0 || local.deviation < least))
            least = local.deviation;
    for (Index k = 0; k < K; ++k) {
        const auto& local = values[static_cast<std::size_t>(k)];
        data.value(k, 0) = local.value;
        data.deviation(k, 0) = std::max(local.deviation, least);
    }
    if (least == 0.0)
        data.deviation.resize(0, 0);
    return data;
}

}  // namespace excursion
