// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/TargetForecast.h"

#include "Engine/Error.h"
#include "Engine/Loudspeaker/Resonance.h"
#include "Engine/Loudspeaker/SensorResponse.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Predistortion/Linearizer.h"
#include "Engine/Predistortion/Predistorter.h"
#include "Engine/Predistortion/Speaker.h"
#include "Engine/Predistortion/TargetFilter.h"
#include "Engine/Signal/Level.h"
#include "Engine/Signal/Multisine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <tuple>

namespace excursion {
namespace {

constexpr double none = std::numeric_limits<double>::infinity();
constexpr double rate = 48000.0;
constexpr double mostRoom = 100.0;  // a factor
constexpr int sines = 9;
constexpr double pi = std::numbers::pi;

double inDecibels(double factor) { return 20.0 * std::log10(factor); }

using Peak = ForecastSubject::Peak;

/// A driver that is linearized towards a target, played to without limits.
class Rehearsed {
public:
    Rehearsed(const Model& model, const OwnLinearPart& own, double amount, const Target& target)
        : filter_(own, rate), linearizer_(undonePart(model), rate), amount_(amount)
    {
        filter_.aim(target);
        filter_.jump();
    }

    /// Infinite where a driver beyond its laws asks for no number.
    Peak played(const std::vector<double>& signal, std::size_t from, double level)
    {
        filter_.reset();
        linearizer_.reset();
        Peak peak;
        for (std::size_t n = 0; n < signal.size(); ++n) {
            const double out = linearizer_.step(filter_.step(level * signal[n]), amount_, none),
                         x = linearizer_.cone().motion().x;
            if (!std::isfinite(out))
                peak.voltage = none;
            if (!std::isfinite(x))
                return {none, none, 0.0};
            if (n < from)
                continue;
            peak.displacement = std::max(peak.displacement, std::abs(x));
            peak.voltage = std::max(peak.voltage, std::abs(out));
        }
        return peak;
    }

private:
    TargetFilter filter_;
    Linearizer linearizer_;
    double amount_;
};

/// By how much a signal with that peak may be louder, and what comes first.
struct Room {
    double factor = none;
    TargetForecast::Peaks::First first = TargetForecast::Peaks::First::displacement;
};

Room roomOf(const Peak& peak, double displacementLimit, double voltageLimit)
{
    using First = TargetForecast::Peaks::First;
    Room room;
    for (const auto& [value, limit, which] : {std::tuple {peak.displacement, displacementLimit, First::displacement},
                                              {peak.voltage, voltageLimit, First::voltage},
                                              {peak.region, 1.0, First::region}})
        if (value > 0.0 && limit / value < room.factor)
            room = {limit / value, which};
    return room;
}

/// @param signal  V, peak of `volts`; what comes before `from` is not judged
TargetForecast::Peaks judged(const ForecastSubject& subject, const ForecastSubject::Play& play,
                             const PredistortionControls& controls, const std::vector<double>& signal, std::size_t from)
{
    const double limit = subject.share * controls.displacementLimit;
    auto peak = play(signal, from, 1.0);
    TargetForecast::Peaks peaks {peak.displacement, peak.voltage, 0.0, {}};
    if (const double room = roomOf(peak, limit, none).factor; room < 1.0)
        peaks.voltage = play(signal, from, room).voltage;
    // How far a linearized driver goes is proportional to the signal, what voltage that takes is nearly so.
    double level = 1.0;
    for (int k = 0; k < 10; ++k) {
        const auto room = roomOf(peak, limit, controls.voltageLimit);
        peaks.first = room.first;
        if (std::isinf(room.factor)) {
            peaks.roomDb = none;
            return peaks;
        }
        if (room.factor >= 1.0 && (room.factor < 1.003 || level >= mostRoom))
            break;
        level = std::min(level * std::clamp(0.999 * room.factor, 0.1, mostRoom), mostRoom);
        peak = play(signal, from, level);
    }
    peaks.roomDb = inDecibels(level);
    return peaks;
}

/// Two periods, the first of which is for settling.
std::vector<double> pink(const ForecastSubject& subject, double low, double volts)
{
    MultisineOptions options;
    options.sampleRate = subject.sampleRate;
    options.period = 32768;
    options.bandLow = low;
    options.bandHigh = std::min({5000.0, subject.highest, 0.4 * subject.sampleRate});
    auto signal = multisine(options, chooseLines(options), 0);
    const double scale = volts / peakOf(signal);
    for (auto& sample : signal)
        sample *= scale;
    const auto period = signal;
    signal.insert(signal.end(), period.begin(), period.end());
    return signal;
}

TargetForecast::Peaks worstSine(const ForecastSubject& subject, const ForecastSubject::Play& play,
                                const PredistortionControls& controls, double low, double high, double volts)
{
    const double rate = subject.sampleRate;
    TargetForecast::Peaks worst {0.0, 0.0, none, {}};
    for (int k = 0; k < sines; ++k) {
        const double f = low * std::pow(high / low, static_cast<double>(k) / (sines - 1));
        const auto from = static_cast<std::size_t>((0.15 + 4.0 / f) * rate),
                   length = from + static_cast<std::size_t>(1.25 / f * rate);
        std::vector<double> signal(length);
        for (std::size_t n = 0; n < length; ++n)
            signal[n] = volts * std::sin(2.0 * pi * f * static_cast<double>(n) / rate);
        const auto peaks = judged(subject, play, controls, signal, from);
        worst.displacement = std::max(worst.displacement, peaks.displacement);
        worst.voltage = std::max(worst.voltage, peaks.voltage);
        if (peaks.roomDb < worst.roomDb) {
            worst.roomDb = peaks.roomDb;
            worst.first = peaks.first;
        }
    }
    return worst;
}

}  // namespace

TargetForecast forecastTarget(const ForecastSubject& subject, const PredistortionControls& controls, double volts,
                              const Progress& progress)
{
    if (!(volts > 0.0 && std::isfinite(volts)))
        throw Error(Error::Kind::usage, "What a target costs is told for a voltage above zero.");
    const auto& own = subject.own;
    own.require(controls.target);
    TargetForecast told;
    told.equalizes = controls.target.equalizes();
    told.own = own.single.value_or(Resonance {subject.resonance, none});
    told.played = own.single ? own.played(controls.target) : told.own;
    const double lower = std::min(told.own.frequency, told.played.frequency),
                 higher = std::max(told.own.frequency, told.played.frequency);

    TargetFilter filter(own, subject.sampleRate);
    filter.aim(controls.target);
    filter.jump();
    const auto gain = [&filter](double f) { return std::abs(filter.at(f)); };
    told.lowGainDb = inDecibels(gain(0.0));
    constexpr double perOctave = 24.0;
    double least = std::max(5.0, lower / 4.0), most = 20.0 * higher;
    if (controls.target.kind == Target::Kind::flat)
        most = std::max(most, 2.0 * controls.target.high);
    else if (told.equalizes)
        most = 20000.0;
    most = std::min({most, 0.4 * subject.sampleRate, subject.highest});
    for (double f = least; f < most; f *= std::exp2(1.0 / perOctave))
        told.frequency.push_back(f);
    told.mostGainDb = told.lowGainDb;
    for (const double f : told.frequency) {
        const double more = gain(f), sound = subject.soundDb(f);
        told.ownDb.push_back(sound);
        told.targetDb.push_back(sound + inDecibels(more));
        if (subject.motion) {
            const double x = std::abs(subject.motion(f));
            told.ownMoves.push_back(volts * x);
            told.targetMoves.push_back(volts * x * more);
        }
        told.ownVoltage.push_back(volts);
        told.targetVoltage.push_back(volts * more);
        if (inDecibels(more) > told.mostGainDb + 1e-9) {
            told.mostGainDb = inDecibels(more);
            told.mostGainFrequency = f;
        }
    }

    const auto signal = pink(subject, std::min(20.0, lower / 3.0), volts);
    const auto judge = [&](const Target& target, TargetForecast::Peaks& byPink, TargetForecast::Peaks& bySine) {
        const auto play = [linearized = subject.linearized(target), &progress](const std::vector<double>& sound,
                                                                               std::size_t from, double level) {
            progress.at(0.0, "forecasting the target");
            return linearized(sound, from, level);
        };
        byPink = judged(subject, play, controls, signal, signal.size() / 2);
        bySine = worstSine(subject, play, controls, lower / 4.0, std::min(4.0 * higher, 0.4 * subject.sampleRate),
                           volts);
    };
    judge({}, told.ownPink, told.ownSine);
    if (controls.target.kind == Target::Kind::own) {
        told.targetPink = told.ownPink;
        told.targetSine = told.ownSine;
    } else {
        judge(controls.target, told.targetPink, told.targetSine);
    }
    return told;
}

TargetForecast forecastTarget(const Model& model, const PredistortionControls& controls, double volts,
                              const Progress& progress)
{
    requireRunnable(model, {rate, 1});
    ForecastSubject subject;
    subject.own = OwnLinearPart(model);
    subject.resonance = resonanceOf(model);
    subject.sampleRate = rate;
    const auto straight = withoutSensors(linearPart(model));
    subject.motion = [straight](double f) {
        return respond(straight, {Quantity::displacement}, {f}).front().value.front();
    };
    if (controls.target.equalizes()) {
        subject.soundDb = [straight](double f) {
            return inDecibels(std::abs(respond(straight, {Quantity::pressure}, {f}).front().value.front()));
        };
    } else {
        subject.soundDb = [motion = subject.motion, flat = plateau(model)](double f) {
            const double w = 2.0 * pi * f;
            return inDecibels(w * w * std::abs(motion(f)) / flat);
        };
    }
    subject.share = Predistorter::share(model, controls.margin);
    subject.linearized = [&model, &own = subject.own, amount = controls.amount](const Target& target) {
        auto driver = std::make_shared<Rehearsed>(model, own, amount, target);
        return [driver](const std::vector<double>& signal, std::size_t from, double level) {
            return driver->played(signal, from, level);
        };
    };
    return forecastTarget(subject, controls, volts, progress);
}

TargetForecast withoutLengths(TargetForecast told)
{
    told.ownMoves.clear();
    told.targetMoves.clear();
    for (auto* peaks : {&told.ownPink, &told.targetPink, &told.ownSine, &told.targetSine})
        peaks->displacement = 0.0;
    return told;
}

}  // namespace excursion
