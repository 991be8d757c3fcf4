// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/TargetForecast.h"

#include "Engine/Error.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Predistortion/Linearizer.h"
#include "Engine/Predistortion/Speaker.h"
#include "Engine/Predistortion/TargetFilter.h"
#include "Engine/Signal/Level.h"
#include "Engine/Signal/Multisine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace excursion {
namespace {

constexpr double none = std::numeric_limits<double>::infinity();
constexpr double rate = 48000.0;
constexpr double mostRoom = 100.0;  // a factor
constexpr int sines = 9;
constexpr double pi = std::numbers::pi;

double inDecibels(double factor) { return 20.0 * std::log10(factor); }

/// A driver that is linearized towards a target, played to without limits.
class Rehearsed {
public:
    Rehearsed(const Model& model, const PredistortionControls& controls, const Target& target)
        : filter_(model, rate), linearizer_(undonePart(model), rate), controls_(controls)
    {
        filter_.aim(target);
        filter_.jump();
    }

    /// @param signal  V, peak of `volts`; what comes before `from` is not judged
    TargetForecast::Peaks judge(const std::vector<double>& signal, std::size_t from)
    {
        auto peak = played(signal, from, 1.0);
        TargetForecast::Peaks peaks {peak.displacement, peak.voltage, 0.0, true};
        if (const double room = controls_.displacementLimit / peak.displacement; room < 1.0)
            peaks.voltage = played(signal, from, room).voltage;
        if (std::isinf(controls_.displacementLimit) && std::isinf(controls_.voltageLimit)) {
            peaks.roomDb = none;
            return peaks;
        }
        // How far a linearized driver goes is proportional to the signal, what voltage that takes is nearly so.
        double level = 1.0;
        for (int k = 0; k < 10; ++k) {
            const double byMotion = controls_.displacementLimit / peak.displacement,
                         byVoltage = controls_.voltageLimit / peak.voltage, room = std::min(byMotion, byVoltage);
            peaks.byDisplacement = byMotion < byVoltage;
            if (room >= 1.0 && (room < 1.003 || level >= mostRoom))
                break;
            level = std::min(level * std::clamp(0.999 * room, 0.1, mostRoom), mostRoom);
            peak = played(signal, from, level);
        }
        peaks.roomDb = inDecibels(level);
        return peaks;
    }

private:
    struct Peak {
        double displacement = 0.0, voltage = 0.0;
    };
    /// Infinite where a driver beyond its laws asks for no number.
    Peak played(const std::vector<double>& signal, std::size_t from, double level)
    {
        filter_.reset();
        linearizer_.reset();
        Peak peak;
        for (std::size_t n = 0; n < signal.size(); ++n) {
            const double out = linearizer_.step(filter_.step(level * signal[n]), controls_.amount, none),
                         x = linearizer_.cone().motion().x;
            if (!std::isfinite(out))
                peak.voltage = none;
            if (!std::isfinite(x))
                return {none, none};
            if (n < from)
                continue;
            peak.displacement = std::max(peak.displacement, std::abs(x));
            peak.voltage = std::max(peak.voltage, std::abs(out));
        }
        return peak;
    }

    TargetFilter filter_;
    Linearizer linearizer_;
    PredistortionControls controls_;
};

/// Two periods, the first of which is for settling.
std::vector<double> pink(double low, double volts)
{
    MultisineOptions options;
    options.sampleRate = rate;
    options.period = 32768;
    options.bandLow = low;
    options.bandHigh = 5000.0;
    auto signal = multisine(options, chooseLines(options), 0);
    const double scale = volts / peakOf(signal);
    for (auto& sample : signal)
        sample *= scale;
    const auto period = signal;
    signal.insert(signal.end(), period.begin(), period.end());
    return signal;
}

TargetForecast::Peaks worstSine(Rehearsed& driver, double low, double high, double volts)
{
    TargetForecast::Peaks worst {0.0, 0.0, none, true};
    for (int k = 0; k < sines; ++k) {
        const double f = low * std::pow(high / low, static_cast<double>(k) / (sines - 1));
        const auto from = static_cast<std::size_t>((0.15 + 4.0 / f) * rate),
                   length = from + static_cast<std::size_t>(1.25 / f * rate);
        std::vector<double> signal(length);
        for (std::size_t n = 0; n < length; ++n)
            signal[n] = volts * std::sin(2.0 * pi * f * static_cast<double>(n) / rate);
        const auto peaks = driver.judge(signal, from);
        worst.displacement = std::max(worst.displacement, peaks.displacement);
        worst.voltage = std::max(worst.voltage, peaks.voltage);
        if (peaks.roomDb < worst.roomDb) {
            worst.roomDb = peaks.roomDb;
            worst.byDisplacement = peaks.byDisplacement;
        }
    }
    return worst;
}

}  // namespace

TargetForecast forecastTarget(const Model& model, const PredistortionControls& controls, double volts)
{
    if (!(volts > 0.0 && std::isfinite(volts)))
        throw Error(Error::Kind::usage, "What a target costs is told for a voltage above zero.");
    requireRunnable(model, {rate, 1});
    const OwnResonance resonance(model);
    resonance.require(controls.target);
    TargetForecast told;
    const double f0 = resonanceOf(model.base().parameters);
    told.own = resonance.single.value_or(Resonance {f0, none});
    told.played = resonance.single ? resonance.played(controls.target) : told.own;
    const double lower = std::min(told.own.frequency, told.played.frequency),
                 higher = std::max(told.own.frequency, told.played.frequency);

    TargetFilter filter(model, rate);
    filter.aim(controls.target);
    filter.jump();
    const auto gain = [&filter](double f) { return std::abs(filter.at(f)); };
    told.lowGainDb = inDecibels(gain(0.0));
    constexpr double perOctave = 24.0;
    const double least = std::max(5.0, lower / 4.0), most = std::min(20.0 * higher, 0.4 * rate);
    for (double f = least; f < most; f *= std::exp2(1.0 / perOctave))
        told.frequency.push_back(f);
    const auto motion = respond(linearPart(model), {Quantity::displacement}, told.frequency).front().value;
    const double flat = plateau(model);
    told.mostGainDb = told.lowGainDb;
    for (std::size_t k = 0; k < told.frequency.size(); ++k) {
        const double f = told.frequency[k], w = 2.0 * pi * f, x = std::abs(motion[k]), more = gain(f);
        told.ownDb.push_back(inDecibels(w * w * x / flat));
        told.targetDb.push_back(inDecibels(w * w * x * more / flat));
        told.ownMoves.push_back(volts * x);
        told.targetMoves.push_back(volts * x * more);
        told.ownVoltage.push_back(volts);
        told.targetVoltage.push_back(volts * more);
        if (inDecibels(more) > told.mostGainDb + 1e-9) {
            told.mostGainDb = inDecibels(more);
            told.mostGainFrequency = f;
        }
    }

    const auto signal = pink(std::min(20.0, lower / 3.0), volts);
    const auto judge = [&](const Target& target, TargetForecast::Peaks& byPink, TargetForecast::Peaks& bySine) {
        Rehearsed driver(model, controls, target);
        byPink = driver.judge(signal, signal.size() / 2);
        bySine = worstSine(driver, lower / 4.0, 4.0 * higher, volts);
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

}  // namespace excursion
