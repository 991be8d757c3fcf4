// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Check/Hum.h"

#include "Engine/Numerics/Median.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

namespace excursion {
namespace {

/// The Hann window from 0 to `length`.
double window(std::size_t n, std::size_t length)
{
    return 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(n) / static_cast<double>(length));
}

/// Power spectrum of the used periods less their average, Hann-windowed, averaged over realizations and levels,
/// scaled so that the sum over lines is the mean square of the residual.
std::vector<double> residualSpectrum(const AveragedPeriods& averages, const Channel& channel)
{
    const Excitation& e = averages.excitation();
    const auto length = static_cast<std::size_t>(e.period) * static_cast<std::size_t>(e.periods);
    std::vector<double> power(length / 2 + 1, 0.0), residual(length);
    const double records = static_cast<double>(e.realizations) * static_cast<double>(e.levels.size());
    for (int level = 0; level < static_cast<int>(e.levels.size()); ++level)
        for (int m = 0; m < e.realizations; ++m) {
            const auto used = usedPeriods(averages.take(), channel, level, m);
            const auto& mean = averages.inTime(channel, level, m);
            for (std::size_t n = 0; n < length; ++n) {
                residual[n] = (used[n] - mean[n % mean.size()]) * window(n, length);
            }
            const auto spectrum = fft(residual);
            for (std::size_t k = 1; k < power.size(); ++k)
                power[k] += 2.0 * std::norm(spectrum[k])
                            / (0.375 * static_cast<double>(length) * static_cast<double>(length)) / records;
        }
    return power;
}

double signalPower(const AveragedPeriods& averages, const Channel& channel)
{
    const Excitation& e = averages.excitation();
    double power = 0.0;
    for (int m = 0; m < e.realizations; ++m) {
        const auto& period = averages.inTime(channel, e.loudest(), m);
        double mean = 0.0;
        for (const double value : period)
            mean += value / e.period;
        for (const double value : period)
            power += (value - mean) * (value - mean) / e.period / e.realizations;
    }
    return power;
}

/// The share of a sinusoid's power that the residual spectrum shows within `reach` lines of it: sent through the same
/// average, window and lines. A sinusoid near a line of the period goes with the average, and what is left is torn.
double shareLeft(double frequency, double reach, const Excitation& e, double sampleRate)
{
    constexpr double least = 0.03;  // less depends on a frequency that mains do not keep
    const auto N = static_cast<std::size_t>(e.period), length = N * static_cast<std::size_t>(e.periods);
    const double turn = 2.0 * std::numbers::pi * frequency / sampleRate,
                 centre = frequency / sampleRate * static_cast<double>(length);
    std::complex<double> average = 0.0;
    for (int p = 0; p < e.periods; ++p)
        average += std::polar(1.0 / e.periods, turn * static_cast<double>(N) * p);
    double power = 0.0;
    for (const std::complex<double> phase : {std::complex(1.0, 0.0), std::complex(0.0, 1.0)}) {
        std::vector<double> residual(length);
        for (std::size_t n = 0; n < length; ++n) {
            const std::size_t periodBegin = N * (n / N);
            const auto left = std::polar(1.0, turn * static_cast<double>(periodBegin)) - average;
            residual[n] = (phase * left * std::polar(1.0, turn * static_cast<double>(n % N))).real()
                          * window(n, length);
        }
        const auto spectrum = fft(residual);
        for (std::size_t k = 1; k < spectrum.size(); ++k)
            if (std::abs(static_cast<double>(k) - centre) <= reach)
                power += 2.0 * std::norm(spectrum[k])
                         / (0.375 * static_cast<double>(length) * static_cast<double>(length));
    }
    return std::max(least, power);  // each of the two phases has half of the power
}

/// A loudspeaker that drifts scatters a played line on a harmonic just as hum does: the median of the scatter of the
/// nearest other lines. 0 where no line is played there.
/// @param scatterAt  the largest power of the residual spectrum around a place, in lines of that
double scatteredBeside(double centre, double reach, const Excitation& e, const std::function<double(double)>& scatterAt)
{
    constexpr std::size_t neighbours = 6;
    std::vector<double> places;
    bool played = false;
    for (const int line : e.lines) {
        const double place = static_cast<double>(line) * e.periods;
        if (std::abs(place - centre) <= reach)
            played = true;
        else
            places.push_back(place);
    }
    if (!played || places.empty())
        return 0.0;
    std::sort(places.begin(), places.end(),
              [centre](double a, double b) { return std::abs(a - centre) < std::abs(b - centre); });
    places.resize(std::min(places.size(), neighbours));
    std::vector<double> scatter;
    for (const double place : places)
        scatter.push_back(scatterAt(place));
    return medianOf(scatter);
}

}  // namespace

std::optional<Hum> findHum(const AveragedPeriods& averages, const Channel& channel)
{
    const auto& take = averages.take();
    const Excitation& e = averages.excitation();
    const double signal = signalPower(averages, channel);
    if (e.periods < 2 || !(signal > 0.0))
        return std::nullopt;
    const auto power = residualSpectrum(averages, channel);
    const double spacing = take.sampleRate / (static_cast<double>(e.period) * e.periods);
    double all = 0.0;
    for (const double p : power)
        all += p;

    std::optional<Hum> found;
    for (const double mains : {50.0, 60.0}) {
        Hum hum;
        hum.mains = mains;
        double total = 0.0, seen = 0.0, highest = 0.0;
        for (int harmonic = 1; harmonic <= 6; ++harmonic) {
            const double centre = harmonic * mains / spacing;
            // The mains wander by 0.3 %, a Hann line is two bins wide on either side.
            const double reach = 2.0 + 0.003 * centre, surroundings = std::min(reach + 20.0, 0.45 * mains / spacing);
            if (surroundings < reach + 3.0 || centre - surroundings < 1.0
                || centre + surroundings > static_cast<double>(power.size() - 1))
                continue;
            double sum = 0.0;
            std::vector<double> beside;
            for (auto k = static_cast<std::size_t>(centre - surroundings);
                 static_cast<double>(k) <= centre + surroundings; ++k) {
                const bool near = std::abs(static_cast<double>(k) - centre) <= reach;
                if (near)
                    sum += power[k];
                else if (k % static_cast<std::size_t>(e.periods) != 0)
                    beside.push_back(power[k]);
            }
            // Multiples of the number of periods were taken away with the average.
            const auto scatterAt = [&](double place) {
                double largest = 0.0;
                for (auto k = static_cast<std::size_t>(std::ceil(std::max(1.0, place - reach)));
                     static_cast<double>(k) <= place + reach && k < power.size(); ++k)
                    if (k % static_cast<std::size_t>(e.periods) != 0)
                        largest = std::max(largest, power[k]);
                return largest;
            };
            const double peak = scatterAt(centre),
                         floor = std::max(medianOf(beside), scatteredBeside(centre, reach, e, scatterAt));
            const double standsOut = 10.0 * std::log10(peak / std::max(1e-30 * signal, floor));
            if (standsOut < 15.0)
                continue;
            ++hum.harmonics;
            highest = std::max(highest, standsOut);
            seen += sum;
            total += sum / shareLeft(harmonic * mains, reach, e, take.sampleRate);
        }
        if (hum.harmonics < 2 && highest < 25.0)
            continue;
        hum.db = 10.0 * std::log10(total / signal);
        hum.aboveNoise = 10.0 * std::log10(total / std::max(all - seen, 1e-30 * signal));
        if (!found || hum.db > found->db)
            found = hum;
    }
    return found;
}

}  // namespace excursion
