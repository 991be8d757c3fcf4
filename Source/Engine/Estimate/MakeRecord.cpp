// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/MakeRecord.h"

#include "Engine/Error.h"
#include "Engine/Estimate/Coupling.h"
#include "Engine/Estimate/Wander.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Level.h"
#include "Engine/Take/Motion.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>

namespace excursion {
namespace {

using Spectrum = std::vector<std::complex<double>>;

// of the sample rate: near its half converters and interpolation are not to be trusted
constexpr double trustedBand = 0.42;
constexpr double distortionBand = 2.0;  // times the band: distortion products lie above it, too
// products up to this order do not fold into the compared lines when samples are left out
constexpr double foldingOrder = 6.0;

double power(const Spectrum& spectrum)
{
    double sum = 0.0;
    for (std::size_t k = 1; k < spectrum.size(); ++k)
        sum += std::norm(spectrum[k]);
    return sum;
}

/// Sums over lines of one kind, to be asked between any two.
struct Tally {
    std::vector<double> total, count;

    Tally(const std::vector<double>& raw, const std::vector<char>& played, char kind)
        : total(raw.size() + 1, 0.0), count(raw.size() + 1, 0.0)
    {
        for (std::size_t k = 0; k < raw.size(); ++k) {
            total[k + 1] = total[k] + (played[k] == kind ? raw[k] : 0.0);
            count[k + 1] = count[k] + (played[k] == kind ? 1.0 : 0.0);
        }
    }
    /// The mean from k - reach to k + reach, without line 0 (an offset that drifts); nothing of fewer than `enough`
    /// lines.
    std::optional<double> around(std::size_t k, std::size_t reach, double enough) const
    {
        const std::size_t from = k > reach ? k - reach : 1, to = std::min(count.size() - 1, k + reach + 1);
        const double lines = count[to] - count[from];
        return lines < enough ? std::nullopt : std::optional((total[to] - total[from]) / lines);
    }
};

std::vector<char> marked(const std::vector<int>& lines, std::size_t count)
{
    std::vector<char> played(count, 0);
    for (const int k : lines)
        if (static_cast<std::size_t>(k) < count)
            played[static_cast<std::size_t>(k)] = 1;
    return played;
}

std::size_t reachAt(std::size_t line) { return std::max<std::size_t>(12, line / 16); }

/// The scatter of a few periods is a noisy estimate of the noise; neighbouring lines share it. Played lines share it
/// among themselves, the others, too: what drifts in the course of the take, as a coil that warms, scatters what was
/// played and hardly anything else. A line that sticks out (hum) keeps its own level. Of nothing, nothing.
std::vector<double> smoothVariance(const std::vector<double>& raw, const std::vector<int>& excited)
{
    constexpr double enough = 12.0;  // lines that share
    const auto played = marked(excited, raw.size());
    const Tally silentOnes(raw, played, 0), playedOnes(raw, played, 1);
    auto result = raw;
    for (std::size_t k = 1; k < raw.size(); ++k) {
        auto reach = reachAt(k);
        const auto& alike = played[k] ? playedOnes : silentOnes;
        std::optional<double> mean;
        for (; !mean; reach *= 2)  // on a sparse grid as far as it takes to find enough of them
            mean = alike.around(k, reach, reach < raw.size() ? enough : 1.0);
        result[k] = std::max(*mean, raw[k] / 6.0);
    }
    return result;
}

/// The same with the noise of the silent lines around it on each played one, where there are some, and it is less: a
/// drift only adds to the scatter.
std::vector<double> withoutDrift(std::vector<double> smooth, const std::vector<double>& raw,
                                 const std::vector<int>& excited)
{
    constexpr double enough = 6.0;
    const auto played = marked(excited, raw.size());
    const Tally silentOnes(raw, played, 0);
    for (std::size_t k = 0; k < raw.size(); ++k)
        if (played[k])
            smooth[k] = std::min(smooth[k], silentOnes.around(k, reachAt(k), enough).value_or(smooth[k]));
    return smooth;
}

/// @param variance  of each line; empty when unknown, then all lines weigh the same
std::vector<double> deviations(const Spectrum& measured, std::vector<double> variance, double relativeFloor)
{
    const double perLine = power(measured) / static_cast<double>(measured.size());
    constexpr double nominal = 1e-3;  // of unknown noise: only its evenness matters
    std::vector<double> result(measured.size(), std::sqrt(perLine) * nominal);
    if (!variance.empty())
        for (std::size_t k = 0; k < result.size(); ++k)
            result[k] = std::sqrt(variance[k] + perLine * relativeFloor * relativeFloor);
    for (auto& deviation : result)
        deviation = std::max(deviation, 1e-300);
    return result;
}

/// The simulation is driven by the measured input, noise and all. Where nothing was played and nothing stands out of
/// the scatter there is no signal, and the noise need not be played to the model; what the amplifier added is kept.
void silenceNoise(std::vector<double>& period, const std::vector<double>& variance, const std::vector<int>& excited)
{
    constexpr double standsOut = 16.0;  // times the noise power
    auto spectrum = fft(period);
    const auto before = spectrum;
    for (std::size_t k = 0; k < spectrum.size(); ++k)
        if (std::norm(spectrum[k]) < standsOut * variance[k])
            spectrum[k] = 0.0;
    for (const int k : excited)
        spectrum[static_cast<std::size_t>(k)] = before[static_cast<std::size_t>(k)];
    period = inverseFft(spectrum, period.size());
}

/// Peaks upwards and downwards of an averaged period integrated n times within the excited band, in any unit.
std::pair<double, double> integratedPeaks(const AveragedPeriods& averages, const Channel& channel, int level,
                                          int realization, int integrations)
{
    const auto& e = averages.excitation();
    auto spectrum = fft(averages.inTime(channel, level, realization));
    const auto first = static_cast<std::size_t>(e.lines.front()), last = static_cast<std::size_t>(e.lines.back());
    for (std::size_t k = 0; k < spectrum.size(); ++k)
        spectrum[k] = k >= first && k <= last
                          ? spectrum[k] * std::pow(std::complex<double>(0.0, static_cast<double>(k)), -integrations)
                          : 0.0;
    const auto samples = inverseFft(spectrum, static_cast<std::size_t>(e.period));
    const auto [low, high] = std::minmax_element(samples.begin(), samples.end());
    return {*high, -*low};
}

/// The realization that goes least far at the loudest level: of the peaks of displacement, velocity and current to
/// either side (what the channels tell of them; the input's low frequencies when they tell nothing of the cone), each
/// relative to where the others go, its largest is the lowest.
int quietestRealization(const AveragedPeriods& averages)
{
    const auto& take = averages.take();
    const auto& e = averages.excitation();
    const int loudest = e.loudest();
    std::vector<std::pair<const Channel*, int>> motions;
    for (const auto& channel : take.channels)
        // The pressure of a piston follows the acceleration.
        if (const auto n = integrationsToDisplacement(channel.quantity == Quantity::pressure ? Quantity::acceleration
                                                                                             : channel.quantity)) {
            motions.emplace_back(&channel, *n);      // displacement
            motions.emplace_back(&channel, *n - 1);  // velocity
        } else if (channel.quantity == Quantity::current) {
            motions.emplace_back(&channel, 0);
        }
    motions.emplace_back(&take.input(), motions.empty() ? 1 : 0);
    std::vector<double> farthest(static_cast<std::size_t>(e.realizations), 0.0);
    for (const auto& [channel, integrations] : motions) {
        std::vector<double> up, down;
        for (int realization = 0; realization < e.realizations; ++realization) {
            const auto [high, low] = integratedPeaks(averages, *channel, loudest, realization, integrations);
            up.push_back(high);
            down.push_back(low);
        }
        for (auto* peaks : {&up, &down})
            for (std::size_t r = 0; r < peaks->size(); ++r) {
                auto others = *peaks;
                others.erase(others.begin() + static_cast<std::ptrdiff_t>(r));
                if (const double reach = *std::max_element(others.begin(), others.end()); reach > 0.0)
                    farthest[r] = std::max(farthest[r], (*peaks)[r] / reach);
            }
    }
    return static_cast<int>(std::min_element(farthest.begin(), farthest.end()) - farthest.begin());
}

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
    for (auto* deviations : {&section.deviation, &section.silentDeviation})
        for (auto& deviation : *deviations)
            rescaleLines(deviation, window, length);
    section.inputVariance.resize(std::min(length / 2 + 1, section.inputVariance.size()));
    const double share = static_cast<double>(length) / static_cast<double>(window);
    for (auto& variance : section.inputVariance)
        variance *= share * share;
}

/// Samples of a period that a model is simulated with: fewer where lines above the distortion's band need not be there,
/// twice as many where products of its laws would fold onto lines that are.
std::size_t simulatedPeriod(const Measurement& take, double bandHigh)
{
    auto period = static_cast<std::size_t>(take.excitation->period);
    double rate = take.sampleRate;
    const double compared = std::min(distortionBand * bandHigh, trustedBand * rate),
                 needed = compared + foldingOrder * bandHigh;
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

void addPeriodicSections(const AveragedPeriods& averages, const RecordOptions& options, std::size_t simulated,
                         Record& record)
{
    const auto& take = averages.take();
    const auto& e = averages.excitation();
    record.levels = e.levels;
    record.noiseKnown = e.periods > 1;
    const int held = options.holdOut && e.realizations > 1 ? quietestRealization(averages) : -1;
    const int levels = static_cast<int>(e.levels.size());
    for (int level = 0; level < levels; ++level) {
        const auto& scatter = averages.noise(take.input(), level).variance;
        const auto inputVariance = withoutDrift(smoothVariance(scatter, e.lines), scatter, e.lines);
        std::vector<std::vector<double>> variance, steady;
        for (const auto quantity : record.channels) {
            const auto& noise = averages.noise(*take.find(quantity), level).variance;
            variance.push_back(smoothVariance(noise, e.lines));
            steady.push_back(withoutDrift(variance.back(), noise, e.lines));
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
                    section.silentDeviation.push_back(
                        deviations(section.measured.back(), steady[c], options.relativeFloor));
            }
            if (simulated != section.window)
                sampleAnew(section, simulated);
            record.sections.push_back(std::move(section));
        }
    }
    for (const auto quantity : record.channels)
        record.wanderDb.push_back(wanderDb(averages, *take.find(quantity)));
    record.leadIn = simulated * static_cast<std::size_t>(std::max(1, e.settlePeriods));
}

void addAperiodicSections(const Measurement& take, const RecordOptions& options, Record& record)
{
    const std::size_t length = take.length();
    const auto lead = static_cast<std::size_t>(std::max(options.leadInSeconds * take.sampleRate, 1024.0));
    auto window = static_cast<std::size_t>(std::max(options.windowSeconds * take.sampleRate, 2048.0));
    if (length < lead + 256)
        throw Error(Error::Kind::data, "The take is only " + std::to_string(length)
                                           + " samples long; a fit needs at least a second of signal.");
    window = std::min(window, length - lead);
    const std::size_t count = std::max<std::size_t>(1, (length - lead) / window);
    const std::size_t fitted = options.holdOut && count > 1 ? std::max<std::size_t>(1, count * 2 / 3) : count;
    for (std::size_t n = 0; n < count; ++n) {
        const std::size_t begin = lead + n * window;
        Section section;
        section.window = window;
        section.validation = n >= fitted;
        section.begin = n > 0 ? static_cast<double>(begin) / take.sampleRate : 0.0;
        section.end = static_cast<double>(begin + window) / take.sampleRate;
        section.middle = section.end - 0.5 * static_cast<double>(window) / take.sampleRate;
        const auto& input = take.input().samples;
        section.input.assign(input.begin() + static_cast<std::ptrdiff_t>(begin - lead),
                             input.begin() + static_cast<std::ptrdiff_t>(begin + window));
        for (const auto quantity : record.channels) {
            const auto& samples = take.find(quantity)->samples;
            section.measured.push_back(fft(std::span(samples).subspan(begin, window)));
            section.deviation.push_back(deviations(section.measured.back(), {}, options.relativeFloor));
        }
        record.sections.push_back(std::move(section));
    }
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
    record.bandLow = 0.0;
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
        addAperiodicSections(take, options, record);
    }
    uncouple(record, take.coupling);
    if (const auto pressure = record.channelIndex(Quantity::pressure))
        takeOffHighPass(record, *pressure, options.microphoneCorner);
    if (record.bandLow <= 0.0)
        record.bandLow = std::min(10.0, 0.01 * take.sampleRate);
    record.highFrequency = std::min(trustedBand * std::min(record.sampleRate, take.sampleRate),
                                    distortionBand * record.bandHigh);
    return record;
}

Record makeRecord(const Measurement& take, const RecordOptions& options)
{
    return makeRecord(AveragedPeriods(take), options);
}

}  // namespace excursion
