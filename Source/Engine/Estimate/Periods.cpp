// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/Periods.h"

#include "Engine/Error.h"
#include "Engine/Signal/Fft.h"

#include <cassert>

namespace excursion {
namespace {

std::size_t startOf(const Excitation& e, int level, int realization)
{
    return static_cast<std::size_t>(e.samplesPerRealization())
           * (static_cast<std::size_t>(level) * static_cast<std::size_t>(e.realizations)
              + static_cast<std::size_t>(realization));
}

}  // namespace

const Excitation& periodicExcitation(const Measurement& take)
{
    if (!take.excitation)
        throw Error(Error::Kind::data, "The take says nothing of its excitation, so it cannot be cut into periods; "
                                       "describe the excitation in measurement.json or use a take played with a plan.");
    const Excitation& e = *take.excitation;
    if (e.period < 2 || e.periods < 1 || e.settlePeriods < 0 || e.realizations < 1 || e.levels.empty())
        throw Error(Error::Kind::data, "The take's excitation needs a period of at least 2 samples, one used period, "
                                       "one realization and one level.");
    if (static_cast<long>(take.length()) < e.totalSamples())
        throw Error(Error::Kind::data, "The record has " + std::to_string(take.length())
                                           + " samples but its excitation " + std::to_string(e.totalSamples())
                                           + ": the recording was cut short; "
                                             "record again or lower the number of realizations or levels.");
    return e;
}

const std::vector<int>& excitedLines(const Measurement& take)
{
    const Excitation& e = periodicExcitation(take);
    if (e.lines.empty())
        throw Error(Error::Kind::data, "The take's excitation does not name its excited lines, and they were not "
                                       "found in the input channel.");
    if (e.lines.front() < 1 || e.lines.back() > e.period / 2)
        throw Error(Error::Kind::data,
                    "The take's excited lines must lie in 1 .. period/2 = " + std::to_string(e.period / 2) + ".");
    return e.lines;
}

std::span<const double> onePeriod(const Measurement& take, const Channel& channel, int level, int realization,
                                  int period)
{
    const Excitation& e = *take.excitation;
    assert(level >= 0 && level < static_cast<int>(e.levels.size()));
    assert(realization >= 0 && realization < e.realizations);
    assert(period >= -e.settlePeriods && period < e.periods);
    const auto N = static_cast<std::size_t>(e.period);
    const auto start = startOf(e, level, realization) + static_cast<std::size_t>(e.settlePeriods + period) * N;
    return std::span(channel.samples).subspan(start, N);
}

std::span<const double> usedPeriods(const Measurement& take, const Channel& channel, int level, int realization)
{
    const Excitation& e = *take.excitation;
    const auto N = static_cast<std::size_t>(e.period);
    return std::span(channel.samples)
        .subspan(startOf(e, level, realization) + static_cast<std::size_t>(e.settlePeriods) * N,
                 static_cast<std::size_t>(e.periods) * N);
}

std::vector<double> averagePeriod(const Measurement& take, const Channel& channel, int level, int realization)
{
    const Excitation& e = periodicExcitation(take);
    std::vector<double> mean(static_cast<std::size_t>(e.period), 0.0);
    for (int p = 0; p < e.periods; ++p) {
        const auto samples = onePeriod(take, channel, level, realization, p);
        for (std::size_t n = 0; n < mean.size(); ++n)
            mean[n] += samples[n] / e.periods;
    }
    return mean;
}

std::vector<std::vector<std::complex<double>>> periodSpectra(const Measurement& take, const Channel& channel, int level,
                                                             int realization)
{
    const Excitation& e = periodicExcitation(take);
    std::vector<std::vector<std::complex<double>>> spectra;
    for (int p = 0; p < e.periods; ++p)
        spectra.push_back(fft(onePeriod(take, channel, level, realization, p)));
    return spectra;
}

AveragedPeriod averagedPeriod(const Measurement& take, const Channel& channel, int level, int realization)
{
    return averageOf(periodSpectra(take, channel, level, realization));
}

AveragedPeriod averageOf(const std::vector<std::vector<std::complex<double>>>& spectra)
{
    const auto P = static_cast<double>(spectra.size());
    AveragedPeriod result;
    result.mean.resize(spectra.front().size());
    for (const auto& Y : spectra)
        for (std::size_t k = 0; k < Y.size(); ++k)
            result.mean[k] += Y[k] / P;
    if (spectra.size() < 2)
        return result;
    result.variance.resize(result.mean.size());
    for (const auto& Y : spectra)
        for (std::size_t k = 0; k < Y.size(); ++k)
            result.variance[k] += std::norm(Y[k] - result.mean[k]) / (P * (P - 1.0));
    return result;
}

}  // namespace excursion
