// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/Distortion.h"

#include "Engine/Error.h"
#include "Engine/Estimate/Bla.h"
#include "Engine/Estimate/Periods.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace excursion {
namespace {

using Complex = std::complex<double>;

/// Piecewise linear in the line number; held at the ends.
template <class Value>
Value interpolate(const std::vector<int>& lines, const std::vector<Value>& values, int k)
{
    const auto right = std::lower_bound(lines.begin(), lines.end(), k);
    if (right == lines.begin())
        return values.front();
    if (right == lines.end())
        return values.back();
    const auto i = static_cast<std::size_t>(right - lines.begin());
    const double t = static_cast<double>(k - lines[i - 1]) / (lines[i] - lines[i - 1]);
    return values[i - 1] * (1.0 - t) + values[i] * t;
}

/// Sum over the lines of one parity in [first, last], interpolated between detection lines.
double sumOverBand(const std::vector<int>& lines, const std::vector<double>& values, int first, int last, int parity)
{
    double sum = 0.0;
    for (int k = first; k <= last; ++k)
        if (k % 2 == parity)
            sum += interpolate(lines, values, k);
    return sum;
}

std::optional<DistortionTotal> totalOf(const DetectionLines& found, const std::vector<int>& excited, int parity,
                                       double excitedPower, int realizations, int noiseDegrees)
{
    if (found.lines.empty())
        return std::nullopt;
    const int first = excited.front(), last = excited.back();
    const double power = sumOverBand(found.lines, found.power, first, last, parity);
    DistortionTotal total;
    if (found.noise.empty()) {
        total.db = 10.0 * std::log10(std::max(power, std::numeric_limits<double>::min()) / excitedPower);
        return total;
    }
    // Noise alone: power(k) is a mean of M exponentials, and noise(k) itself is known from noiseDegrees
    // real degrees of freedom. Each detection line stands for several of the band, hence the weight.
    const double noise = sumOverBand(found.lines, found.noise, first, last, parity);
    double square = 0.0, weightless = 0.0;
    for (const double n : found.noise) {
        square += n * n;
        weightless += n;
    }
    const double relativeSpread = weightless > 0.0 ? std::sqrt(square) / weightless : 0.0;
    const double deviation = noise * relativeSpread * std::sqrt(1.0 / realizations + 2.0 / noiseDegrees);
    total.significant = power - noise > 4.0 * deviation;
    const double left = total.significant ? power - noise : std::max(power - noise, 0.0) + 4.0 * deviation;
    total.db = 10.0 * std::log10(std::max(left, std::numeric_limits<double>::min()) / excitedPower);
    return total;
}

}  // namespace

DistortionResult distortion(const Measurement& take, Quantity outputQuantity, int level)
{
    const Excitation& e = periodicExcitation(take);
    const auto& excited = excitedLines(take);
    if (const auto even = std::find_if(excited.begin(), excited.end(), [](int k) { return k % 2 == 0; });
        even != excited.end())
        throw Error(Error::Kind::data,
                    "The excitation has even lines (the first is " + std::to_string(*even)
                        + "), so even and odd distortion cannot be told apart; play a multisine on an "
                          "odd or odd-random grid.");
    const auto linear = bla(take, outputQuantity, level).frf.value;
    const Channel& input = take.input();
    const Channel& output = *take.find(outputQuantity);
    const int M = e.realizations, P = e.periods;

    DistortionResult result;
    result.output = outputQuantity;
    result.level = level;
    result.excited = excited;
    result.excitedPower.assign(excited.size(), 0.0);
    for (int k = excited.front() + 1; k < excited.back(); ++k)
        if (!std::binary_search(excited.begin(), excited.end(), k))
            (k % 2 ? result.odd : result.even).lines.push_back(k);

    double bandNoise = 0.0;
    const auto add = [&](DetectionLines& found, const auto& U, const auto& Y, const auto& meanU, const auto& meanY) {
        found.power.resize(found.lines.size());
        if (P > 1)
            found.noise.resize(found.lines.size());
        for (std::size_t i = 0; i < found.lines.size(); ++i) {
            const auto k = static_cast<std::size_t>(found.lines[i]);
            const Complex G = interpolate(excited, linear, found.lines[i]);
            const Complex Yc = meanY[k] - G * meanU[k];
            found.power[i] += std::norm(Yc) / M;
            for (std::size_t p = 0; p < Y.size() && P > 1; ++p)
                found.noise[i] += std::norm(Y[p][k] - G * U[p][k] - Yc) / (P * (P - 1.0)) / M;
        }
    };
    for (int m = 0; m < M; ++m) {
        const auto U = periodSpectra(take, input, level, m), Y = periodSpectra(take, output, level, m);
        const auto meanU = averageOf(U).mean;
        const auto averagedY = averageOf(Y);
        for (std::size_t i = 0; i < excited.size(); ++i)
            result.excitedPower[i] += std::norm(averagedY.mean[static_cast<std::size_t>(excited[i])]) / M;
        for (int k = excited.front(); k <= excited.back() && P > 1; ++k)
            bandNoise += averagedY.variance[static_cast<std::size_t>(k)] / M;
        add(result.odd, U, Y, meanU, averagedY.mean);
        add(result.even, U, Y, meanU, averagedY.mean);
    }

    double excitedPower = 0.0;
    for (const double power : result.excitedPower)
        excitedPower += power;
    if (!(excitedPower > 0.0))
        throw Error(Error::Kind::data, "The " + std::string(name(outputQuantity))
                                           + " channel has nothing on the excited "
                                             "lines: it is dead.");
    for (auto* found : {&result.odd, &result.even})
        for (const int k : found->lines)
            found->frequency.push_back(k * take.sampleRate / e.period);
    const int noiseDegrees = 2 * M * (P - 1);
    result.oddTotal = totalOf(result.odd, excited, 1, excitedPower, M, noiseDegrees);
    result.evenTotal = totalOf(result.even, excited, 0, excitedPower, M, noiseDegrees);
    if (P > 1)
        result.noiseDb = 10.0 * std::log10(std::max(bandNoise, std::numeric_limits<double>::min()) / excitedPower);
    return result;
}

}  // namespace excursion
