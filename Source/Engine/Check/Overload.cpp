// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Check/Overload.h"

#include "Engine/Numerics/QrFactors.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Level.h"

#include <algorithm>
#include <cmath>
#include <array>
#include <complex>
#include <numeric>
#include <vector>

namespace excursion {
namespace {

constexpr int highestPower = 7;
constexpr double clearlyAbove = 4.0;  // the noise's power
constexpr std::size_t fewestLines = 40;
constexpr double fewestOctaves = 2.0, explainedFrom = 0.65, explainedEverywhere = 0.4, faintest = -60.0;
constexpr std::size_t parts = 4;

using BendPowers = std::array<std::complex<double>, highestPower - 1>;

/// One line of one realization: what it holds, and what each power of the signal would put there: of what the excited
/// lines hold, and of all that the channel holds.
struct Line {
    int k;
    std::complex<double> value;
    double noise;
    BendPowers ofExcited, ofAll;
};

/// Spectra of the powers of a signal, [n - 2].
std::vector<std::vector<std::complex<double>>> powersOf(const std::vector<double>& signal, double offset, double scale)
{
    std::vector<std::vector<std::complex<double>>> powers;
    std::vector<double> power(signal.size());
    for (int n = 2; n <= highestPower; ++n) {
        for (std::size_t t = 0; t < signal.size(); ++t)
            power[t] = scale * std::pow((signal[t] - offset) / scale, n);
        powers.push_back(fft(power));
    }
    return powers;
}

/// What the channel holds on the excited lines, in time.
std::vector<double> onExcitedLines(const AveragedPeriods& averages, const Channel& channel, int level, int realization)
{
    const auto period = static_cast<std::size_t>(averages.excitation().period);
    const auto& mean = averages.spectrum(channel, level, realization).mean;
    std::vector<std::complex<double>> kept(mean.size());
    for (const int k : averages.lines())
        kept[static_cast<std::size_t>(k)] = mean[static_cast<std::size_t>(k)];
    return inverseFft(kept, period);
}

/// The lines that the excitation leaves out, without what goes with the partner; `signal` receives the channel's power.
std::vector<Line> leftOut(const AveragedPeriods& averages, const Channel& channel, const Channel& partner, int level,
                          int realization, double offset, double scale, double& signal)
{
    const auto& excited = averages.lines();
    const auto& beside = averages.spectrum(partner, level, realization);
    const auto& averaged = averages.spectrum(channel, level, realization);
    const auto ofExcited = powersOf(onExcitedLines(averages, channel, level, realization), 0.0, scale);
    const auto ofAll = powersOf(averages.inTime(channel, level, realization), offset, scale);
    std::vector<Line> lines;
    for (int k = excited.front(); k <= excited.back(); ++k) {
        const auto place = static_cast<std::size_t>(k);
        if (std::binary_search(excited.begin(), excited.end(), k)) {
            signal += std::norm(averaged.mean[place]);
            continue;
        }
        const auto above = std::lower_bound(excited.begin(), excited.end(), k);
        const auto gainAt = [&](int line) {
            return averaged.mean[static_cast<std::size_t>(line)] / beside.mean[static_cast<std::size_t>(line)];
        };
        const int from = *(above - 1), to = *above;
        const auto gain = gainAt(from) + (gainAt(to) - gainAt(from)) * (static_cast<double>(k - from) / (to - from));
        const double noise = averaged.variance.empty()
                                 ? 0.0
                                 : averaged.variance[place] + std::norm(gain) * beside.variance[place];
        Line line {k, averaged.mean[place] - gain * beside.mean[place], noise, {}, {}};
        for (std::size_t n = 0; n < ofAll.size(); ++n) {
            line.ofExcited[n] = ofExcited[n][place];
            line.ofAll[n] = ofAll[n][place];
        }
        lines.push_back(line);
    }
    return lines;
}

/// Mean power and noise over the lines around each.
std::vector<std::pair<double, double>> surroundings(const std::vector<Line>& lines)
{
    constexpr std::size_t reach = 6;
    std::vector<std::pair<double, double>> around;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const std::size_t from = i > reach ? i - reach : 0, to = std::min(lines.size(), i + reach + 1);
        double power = 0.0, noise = 0.0;
        for (std::size_t j = from; j < to; ++j) {
            power += std::norm(lines[j].value);
            noise += lines[j].noise;
        }
        around.emplace_back(power / static_cast<double>(to - from), noise / static_cast<double>(to - from));
    }
    return around;
}

std::optional<Overload> overloadAt(const AveragedPeriods& averages, const Channel& channel, const Channel& partner,
                                   int level)
{
    const Excitation& e = averages.excitation();
    // An offset says nothing about a bend, and powers of it would stand for the signal itself.
    const double samples = static_cast<double>(e.period) * e.realizations;
    double offset = 0.0, squares = 0.0, most = 0.0, least = 0.0;
    for (int m = 0; m < e.realizations; ++m)
        for (const double value : averages.inTime(channel, level, m))
            offset += value / samples;
    for (int m = 0; m < e.realizations; ++m)
        for (const double value : averages.inTime(channel, level, m)) {
            squares += (value - offset) * (value - offset) / samples;
            most = std::max(most, value - offset);
            least = std::min(least, value - offset);
        }
    const double scale = std::sqrt(squares);
    if (!(scale > 0.0))
        return std::nullopt;

    double signal = 0.0, bent = 0.0;
    std::vector<Line> used;
    std::vector<double> weight;
    for (int m = 0; m < e.realizations; ++m) {
        const auto lines = leftOut(averages, channel, partner, level, m, offset, scale, signal);
        const auto around = surroundings(lines);
        for (std::size_t i = 0; i < lines.size(); ++i) {
            bent += std::norm(lines[i].value) - lines[i].noise;
            if (!(around[i].first > clearlyAbove * around[i].second))
                continue;
            used.push_back(lines[i]);
            weight.push_back(1.0 / std::sqrt(around[i].first));
        }
    }
    if (used.size() < fewestLines || !(bent > 0.0))
        return std::nullopt;
    const auto [low, high] = std::minmax_element(used.begin(), used.end(),
                                                 [](const Line& a, const Line& b) { return a.k < b.k; });
    if (high->k < low->k * std::exp2(fewestOctaves))
        return std::nullopt;

    const auto F = static_cast<Eigen::Index>(used.size());
    Eigen::VectorXd b(2 * F);
    const auto weighted = [&](BendPowers Line::*powers) {
        Eigen::MatrixXd A(2 * F, highestPower - 1);
        for (Eigen::Index i = 0; i < F; ++i)
            for (Eigen::Index n = 0; n < A.cols(); ++n) {
                const auto power = weight[static_cast<std::size_t>(i)]
                                   * (used[static_cast<std::size_t>(i)].*powers)[static_cast<std::size_t>(n)];
                A(i, n) = power.real();
                A(F + i, n) = power.imag();
            }
        return A;
    };
    for (Eigen::Index i = 0; i < F; ++i) {
        const auto value = weight[static_cast<std::size_t>(i)] * used[static_cast<std::size_t>(i)].value;
        b[i] = value.real();
        b[F + i] = value.imag();
    }
    const auto A = weighted(&Line::ofExcited);
    const Eigen::VectorXd left = b - A * pivotedSolveVector(A, b);
    // Over a part of the band the motion of a cone is nearly a function of its force; over all of it, it is not.
    std::vector<Eigen::Index> byFrequency(used.size());
    std::iota(byFrequency.begin(), byFrequency.end(), Eigen::Index {0});
    std::stable_sort(byFrequency.begin(), byFrequency.end(), [&](Eigen::Index i, Eigen::Index j) {
        return used[static_cast<std::size_t>(i)].k < used[static_cast<std::size_t>(j)].k;
    });
    const auto explainedOf = [&](std::size_t from, std::size_t to) {
        double before = 0.0, after = 0.0;
        for (std::size_t n = from; n < to; ++n) {
            const auto i = byFrequency[n];
            const auto place = static_cast<std::size_t>(i);
            const double noise = used[place].noise * weight[place] * weight[place];
            before += b[i] * b[i] + b[F + i] * b[F + i] - noise;
            after += left[i] * left[i] + left[F + i] * left[F + i] - noise;
        }
        return before > 0.0 ? 1.0 - std::max(0.0, after) / before : 0.0;
    };
    for (std::size_t part = 0; part < parts; ++part)
        if (explainedOf(part * used.size() / parts, (part + 1) * used.size() / parts) < explainedEverywhere)
            return std::nullopt;
    Overload overload;
    overload.level = level;
    overload.db = decibelsOf(bent / signal);
    overload.explained = explainedOf(0, used.size());
    const Eigen::VectorXd a = pivotedSolveVector(weighted(&Line::ofAll), b);
    for (const double extreme : {most, least}) {
        double before = extreme / scale;
        for (int n = 2; n <= highestPower; ++n)
            before -= a[n - 2] * std::pow(extreme / scale, n);
        overload.compression = std::max(overload.compression, decibelsOf(std::pow(before * scale / extreme, 2)));
    }
    // What grows beyond its due was not held back: then it is the partner that bends.
    constexpr double leastCompression = 0.02;  // dB
    return overload.compression > leastCompression ? std::optional(overload) : std::nullopt;
}

}  // namespace

std::optional<Overload> findOverload(const AveragedPeriods& averages, const Channel& channel, const Channel& partner)
{
    std::optional<Overload> worst;
    for (int level = 0; level < static_cast<int>(averages.excitation().levels.size()); ++level)
        if (const auto here = overloadAt(averages, channel, partner, level);
            here && here->explained > explainedFrom && here->db > faintest)
            if (!worst || here->db > worst->db)
                worst = here;
    return worst;
}

}  // namespace excursion
