// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/PredictedDistortion.h"

#include "Engine/Error.h"
#include "Engine/Loudspeaker/Resonance.h"
#include "Engine/Predistortion/CouplingFilter.h"
#include "Engine/Predistortion/Predistorter.h"
#include "Engine/Predistortion/Speaker.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Level.h"
#include "Engine/Signal/Multisine.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

/// The last of so many periods of the acceleration, as a spectrum.
std::vector<std::complex<double>> settled(Speaker& speaker, Predistorter* bend, CouplingFilter amplifier,
                                          const std::vector<double>& period, int periods, const Progress& progress)
{
    std::vector<double> out(period.size());
    for (int k = 0; k < periods; ++k) {
        progress.at(0.0, "predicting the distortion");
        out = period;
        if (bend != nullptr)
            bend->process(out.data(), out.data(), out.size());
        for (auto& sample : out)
            sample = amplifier.pass(sample);
        speaker.process(out.data(), out.data(), out.size());
    }
    return fft(out);
}

}  // namespace

PredictedDistortion predictDistortion(const Model& model, const PredistortionControls& controls, double volts,
                                      const RealTimeOptions& options, const Progress& progress)
{
    if (!(volts > 0.0))
        throw Error(Error::Kind::usage, "A prediction of distortion needs a voltage above zero.");
    requireRunnable(model, options);
    const double resonance = resonanceOf(model);
    MultisineOptions tones;
    tones.sampleRate = options.sampleRate;
    tones.period = 16384;
    tones.grid = Grid::oddRandom;
    tones.bandHigh = std::min(8000.0, 0.17 * options.sampleRate);
    tones.bandLow = std::clamp(resonance / 3.0, 2.0 * options.sampleRate / tones.period, 0.1 * tones.bandHigh);
    const auto lines = chooseLines(tones);
    auto period = multisine(tones, lines, 0);
    const double scale = volts / peakOf(period);
    for (auto& sample : period)
        sample *= scale;

    const int periods = 4
                        + static_cast<int>(
                            std::ceil(options.coupling.forgetting() * options.sampleRate / tones.period));
    Speaker plain(model, options), played(model, options);
    Predistorter bend(model, options, controls);
    const CouplingFilter amplifier(options.coupling, options.sampleRate);
    const auto before = settled(plain, nullptr, amplifier, period, periods, progress),
               after = settled(played, &bend, amplifier, period, periods, progress);

    PredictedDistortion result;
    result.displacement = plain.collectMeters().displacement;
    const double resolution = options.sampleRate / tones.period;
    constexpr double fewest = 8.0;  // lines in a band: of fewer, all might be excited or all even
    double signalSum = 0.0, bentSum = 0.0, beforeSum = 0.0, afterSum = 0.0;
    const auto db = [](double power, double reference) {
        return 10.0 * std::log10(std::max(power, 1e-30 * reference) / reference);
    };
    for (double low = tones.bandLow, high; low < tones.bandHigh; low = high) {
        high = std::min(std::max(low * std::cbrt(2.0), low + fewest * resolution), tones.bandHigh);
        double signal = 0.0, bentSignal = 0.0, first = 0.0, second = 0.0;
        for (auto k = static_cast<std::size_t>(std::ceil(low / resolution));
             k < static_cast<std::size_t>(std::ceil(high / resolution)); ++k)
            if (std::binary_search(lines.begin(), lines.end(), static_cast<int>(k))) {
                signal += std::norm(before[k]);
                bentSignal += std::norm(after[k]);
            } else {
                first += std::norm(before[k]);
                second += std::norm(after[k]);
            }
        if (signal <= 0.0 || bentSignal <= 0.0)
            continue;
        result.frequency.push_back(std::sqrt(low * high));
        result.before.push_back(db(first, signal));
        result.after.push_back(db(second, bentSignal));
        signalSum += signal;
        bentSum += bentSignal;
        beforeSum += first;
        afterSum += second;
    }
    result.beforeDb = db(beforeSum, signalSum);
    result.afterDb = db(afterSum, bentSum);
    return result;
}

}  // namespace excursion
