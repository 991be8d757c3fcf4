// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/MakeRecord.h"

#include "Engine/Error.h"
#include "Engine/Estimate/Coupling.h"
#include "Engine/Estimate/DriftNoise.h"
#include "Engine/Estimate/DrivenBand.h"
#include "Engine/Estimate/HoldOut.h"
#include "Engine/Estimate/LineNoise.h"
#include "Engine/Estimate/Wander.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Level.h"
#include "Engine/Signal/Resample.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace excursion {
namespace {

using Spectrum = std::vector<std::complex<double>>;

// of the sample rate: near its half converters and interpolation are not to be trusted
constexpr double trustedBand = 0.42;
constexpr double distortionBand = 2.0;  // times the band: distortion products lie above it, too
// products up to this order do not fold into the compared lines when samples are left out
constexpr double foldingOrder = 6.0;

/// Scales the lines of a DFT from `window` to `length` samples, and cuts them or adds zeros.
template <class Value>
void rescaleLines(std::vector<Value>& lines, std::size_t window, std::size_t length)
{
    const double share = static_cast<double>(length) / static_cast<double>(window);
    lines.resize(length / 2 + 1);
    for (auto& value : lines)
        value *= share;
}

/// The section with `length` samples a period: the same lines, without those above half of a lower rate. Above half of
/// the former rate nothing is known, and nothing compared.
void sampleAnew(Section& section, std::size_t length)
{
    const auto window = section.window;
    auto input = fft(section.input);
    rescaleLines(input, window, length);
    input[std::min(window, length) / 2] = 0.0;
    section.input = inverseFft(input, length);
    section.window = length;
    for (auto& measured : section.measured)
        rescaleLines(measured, window, length);
    for (auto* deviations : {&section.deviation, &section.deviationWithoutDrift})
        for (auto& deviation : *deviations)
            rescaleLines(deviation, window, length);
    section.inputVariance.resize(std::min(length / 2 + 1, section.inputVariance.size()));
    const double share = static_cast<double>(length) / static_cast<double>(window);
    for (auto& variance : section.inputVariance)
        variance *= share * share;
}

/// The sample rate from which on products of a model's laws do not fold onto lines that are compared.
double rateFor(double bandHigh, double rate)
{
    return std::min(distortionBand * bandHigh, trustedBand * rate) + foldingOrder * bandHigh;
}

/// Samples of a period that a model is simulated with: fewer where lines above the distortion's band need not be there,
/// twice as many where products of its laws would fold onto lines that are.
std::size_t simulatedPeriod(const Measurement& take, double bandHigh)
{
    auto period = static_cast<std::size_t>(take.excitation->period);
    double rate = take.sampleRate;
    const double needed = rateFor(bandHigh, rate);
    if (needed > rate)
        return 2 * period;
    for (; period % 2 == 0 && needed <= 0.5 * rate; rate *= 0.5)
        period /= 2;
    return period;
}

/// Section::power: what heats the coil before the loudspeaker has settled, and less once the coil is warm.
std::vector<double> powerByPeriod(const Measurement& take, int section)
{
    const auto& e = *take.excitation;
    const auto* current = take.find(Quantity::current);
    if (!current)
        return {};
    const auto period = static_cast<std::size_t>(e.period),
               begin = static_cast<std::size_t>(e.samplesPerRealization()) * static_cast<std::size_t>(section);
    const std::span<const double> all(current->samples);
    std::vector<double> power;
    double averaged = 0.0;
    for (int p = 0; p < e.settlePeriods + e.periods; ++p) {
        power.push_back(std::pow(rmsOf(all.subspan(begin + static_cast<std::size_t>(p) * period, period)), 2));
        averaged += p < e.settlePeriods ? 0.0 : power.back() / e.periods;
    }
    if (!(averaged > 0.0))
        return {};
    for (auto& one : power)
        one /= averaged;
    return power;
}

/// How far above the band's begin a driver still rings long enough to carry something from one period into the next.
constexpr double ringing = 40.0;

void addPeriodicSections(const AveragedPeriods& averages, const RecordOptions& options, std::size_t simulated,
                         Record& record)
{
    const auto& take = averages.take();
    const auto& e = averages.excitation();
    record.levels = e.levels;
    record.noiseKnown = e.periods > 1;
    const int held = options.holdOut && e.realizations > 1 ? leastReaching(averages) : -1;
    const int levels = static_cast<int>(e.levels.size());
    for (int level = 0; level < levels; ++level) {
        const auto steadyNoise = [&](const Channel& channel, std::vector<double> smooth) {
            return withoutDrift(std::move(smooth), averages.noise(channel, level).variance, e.lines,
                                [&] { return noiseBesideDrift(averages, channel, level); });
        };
        const auto inputVariance = steadyNoise(take.input(),
                                               smoothVariance(averages.noise(take.input(), level).variance, e.lines));
        std::vector<std::vector<double>> variance, steady;
        for (const auto quantity : record.channels) {
            const auto& channel = *take.find(quantity);
            variance.push_back(smoothVariance(averages.noise(channel, level).variance, e.lines));
            steady.push_back(steadyNoise(channel, variance.back()));
        }
        for (int realization = 0; realization < e.realizations; ++realization) {
            Section section;
            section.level = level;
            section.realization = realization;
            section.periodic = true;
            section.validation = realization == held;
            const double period = static_cast<double>(e.period) / take.sampleRate;
            const int played = e.settlePeriods + e.periods;
            section.begin = period * played * (level * e.realizations + realization);
            section.end = section.begin + period * played;
            section.middle = section.end - 0.5 * period * e.periods;
            section.power = powerByPeriod(take, level * e.realizations + realization);
            section.input = averages.inTime(take.input(), level, realization);
            section.window = section.input.size();
            section.excited = e.lines;
            section.inputVariance = inputVariance;
            if (!inputVariance.empty())
                silenceNoise(section.input, inputVariance, e.lines);
            for (std::size_t c = 0; c < record.channels.size(); ++c) {
                section.measured.push_back(fft(averages.inTime(*take.find(record.channels[c]), level, realization)));
                section.deviation.push_back(deviations(section.measured.back(), variance[c], options.relativeFloor));
                if (steady != variance)
                    section.deviationWithoutDrift.push_back(
                        deviations(section.measured.back(), steady[c], options.relativeFloor));
            }
            if (!(take.coupling > 0.0))  // a recorder's own forgets as slowly, and is taken off line by line
                section.departure = inputDeparture(averages, level, realization, section.input, inputVariance,
                                                   std::min(record.bandHigh, ringing * record.bandLow), simulated);
            if (simulated != section.window)
                sampleAnew(section, simulated);
            record.sections.push_back(std::move(section));
        }
    }
    for (const auto quantity : record.channels)
        record.wanderDb.push_back(wanderDb(averages, *take.find(quantity)));
    record.leadIn = simulated * static_cast<std::size_t>(std::max(1, e.settlePeriods));
}

/// The first of periods that nothing settled before as a settling one: after a jump it is another one. A take that was
/// steady from its begin loses little.
Measurement withSettling(Measurement take)
{
    take.excitation->settlePeriods = 1;
    --take.excitation->periods;
    return take;
}

/// A take without periods at a rate that its band needs, or as it is.
Measurement thinned(Measurement take, double bandHigh)
{
    double fewer = 1.0;
    constexpr double fewest = 64.0;  // what the interpolation can do
    while (fewer < fewest && rateFor(bandHigh, take.sampleRate) <= 0.5 * take.sampleRate / fewer)
        fewer *= 2.0;
    if (fewer > 1.0)
        for (auto& channel : take.channels)
            channel.samples = resampled(channel.samples, fewer);
    take.sampleRate /= fewer;
    return take;
}

/// @param recordedRate  Hz, before the take was thinned
void addWindows(const Measurement& take, double recordedRate, const RecordOptions& options, Record& record)
{
    const std::size_t length = take.length();
    const auto samplesOf = [&](double seconds, double fewest) {
        return static_cast<std::size_t>(std::lround(take.sampleRate * std::max(seconds, fewest / recordedRate)));
    };
    const auto lead = samplesOf(options.leadInSeconds, 1024.0);
    auto window = samplesOf(options.windowSeconds, 2048.0);
    if (length < lead + 256)
        throw Error(Error::Kind::data,
                    "The take is only "
                        + std::to_string(std::lround(static_cast<double>(length) / take.sampleRate * recordedRate))
                        + " samples long; a fit needs at least a second of signal.");
    window = std::min(window, length - lead);
    const std::size_t count = std::max<std::size_t>(1, (length - lead) / window);
    std::vector<double> whole(record.channels.size(), 0.0);  // power of a channel, on all lines of all windows
    for (std::size_t n = 0; n < count; ++n) {
        const std::size_t begin = lead + n * window;
        Section section;
        section.window = window;
        section.begin = n > 0 ? static_cast<double>(begin) / take.sampleRate : 0.0;
        section.end = static_cast<double>(begin + window) / take.sampleRate;
        section.middle = section.end - 0.5 * static_cast<double>(window) / take.sampleRate;
        const auto& input = take.input().samples;
        section.input.assign(input.begin() + static_cast<std::ptrdiff_t>(begin - lead),
                             input.begin() + static_cast<std::ptrdiff_t>(begin + window));
        for (std::size_t c = 0; c < record.channels.size(); ++c) {
            const auto& samples = take.find(record.channels[c])->samples;
            section.measured.push_back(fft(std::span(samples).subspan(begin, window)));
            whole[c] += powerOf(section.measured.back());
        }
        record.sections.push_back(std::move(section));
    }
    // The noise of a sensor is the same in loud and in quiet windows: each by its own power would make those count most
    // that hold nothing else.
    for (auto& section : record.sections)
        for (const double sum : whole)
            section.deviation.push_back(
                evenDeviation(section.measured.front().size(), sum / static_cast<double>(count)));
    record.leadIn = lead;
}

}  // namespace

bool RecordOptions::isValid(std::string* reason) const
{
    if (!(windowSeconds > 0.0) || !(leadInSeconds >= 0.0))
        return refuse(reason, "the window and the lead-in of a record are positive times in seconds");
    if (!(relativeFloor > 0.0 && relativeFloor < 0.1))
        return refuse(reason, "the relative floor of the noise must lie between 0 and 0.1");
    if (!(microphoneCorner >= 0.0 && std::isfinite(microphoneCorner)))
        return refuse(reason, "the corner of a microphone is a frequency in Hz, or 0");
    return true;
}

Record makeRecord(const AveragedPeriods& averages, const RecordOptions& options)
{
    const auto& take = averages.take();
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "The take cannot be prepared: " + reason + ".");
    if (take.excitation && take.excitation->settlePeriods == 0 && take.excitation->periods > 1)
        return makeRecord(withSettling(take), options);
    Record record;
    record.sampleRate = take.sampleRate;
    record.driver = take.driver;
    record.electrical = take.find(Quantity::voltage) != nullptr;
    const auto inputQuantity = take.input().quantity;
    for (const auto& channel : take.channels)
        if (channel.quantity != inputQuantity && channel.quantity != Quantity::force
            && (record.electrical || channel.quantity != Quantity::current)
            && std::find(options.setAside.begin(), options.setAside.end(), channel.quantity)
                   == options.setAside.end()) {
            record.channels.push_back(channel.quantity);
            record.units.push_back(channel.unit);
        }
    if (record.channels.empty())
        throw Error(Error::Kind::data,
                    "The take holds no output of the loudspeaker; a fit needs at least one of current, "
                    "displacement, velocity, acceleration or pressure.");

    const bool periodic = take.excitation && take.excitation->settlePeriods > 0;
    record.bandLow = std::min(10.0, 0.01 * take.sampleRate);
    record.bandHigh = trustedBand * take.sampleRate;
    if (periodic) {
        const auto& lines = averages.lines();  // refuses a record that is too short, or in which nothing repeats
        const double resolution = take.sampleRate / take.excitation->period;
        record.bandLow = resolution * lines.front();
        record.bandHigh = resolution * lines.back();
        const auto simulated = simulatedPeriod(take, record.bandHigh);
        record.sampleRate = resolution * static_cast<double>(simulated);
        addPeriodicSections(averages, options, simulated, record);
    } else {
        record.wanderDb.resize(record.channels.size());
        const auto band = drivenBand(take.input().samples, take.sampleRate);
        if (band.high > 0.0) {
            record.bandLow = band.low;
            record.bandHigh = std::min(record.bandHigh, band.high);
        }
        const auto fewer = thinned(take, record.bandHigh);
        record.sampleRate = fewer.sampleRate;
        addWindows(fewer, take.sampleRate, options, record);
        if (options.holdOut)
            holdOutWindows(record);
    }
    uncouple(record, take.coupling);
    if (const auto pressure = record.channelIndex(Quantity::pressure)) {
        takeOffHighPass(record, *pressure, options.microphoneCorner);
        record.microphoneCorner = options.microphoneCorner;
    }
    record.highFrequency = std::min(trustedBand * std::min(record.sampleRate, take.sampleRate),
                                    distortionBand * record.bandHigh);
    return record;
}

Record makeRecord(const Measurement& take, const RecordOptions& options)
{
    return makeRecord(AveragedPeriods(take), options);
}

}  // namespace excursion
