// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Datasheet/ResponseCurves.h"

#include "Engine/Datasheet/ThieleSmall.h"
#include "Engine/Document/Figures.h"
#include "Engine/Error.h"
#include "Engine/Estimate/Bla.h"
#include "Engine/Loudspeaker/SensorResponse.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Take/Air.h"
#include "Engine/Take/ExcitationPlan.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion {
namespace {

void requireCoil(bool electrical)
{
    if (!electrical)
        throw Error(Error::Kind::data, "Without a coil there is neither an impedance nor a sound for a voltage.");
}

/// Index of the level of so many V rms, or of the loudest for 0.
int levelNear(const Measurement& take, double level)
{
    if (!take.hasPeriods() || take.excitation->levels.empty())
        throw Error(Error::Kind::data, "The take has no periods, so its response at a level cannot be told; excursion "
                                       "bla estimates one over the whole record.");
    const auto& levels = take.excitation->levels;
    if (level == 0.0)
        return static_cast<int>(std::max_element(levels.begin(), levels.end()) - levels.begin());
    std::string known;
    for (std::size_t k = 0; k < levels.size(); ++k) {
        constexpr double near = 0.1;
        if (std::abs(levels[k] - level) <= near * level)
            return static_cast<int>(k);
        known += (known.empty() ? "" : ", ") + figure(levels[k], "%.3g");
    }
    throw Error(Error::Kind::data,
                "The take has no level near " + figure(level, "%.3g") + " V rms; it has " + known + ".");
}

void requireChannel(const Measurement& take, Quantity quantity)
{
    requireCoil(take.input().quantity == Quantity::voltage);
    take.channel(quantity);  // throws when it is missing
}

/// To the level of 2.83 V at 1 m over 20 uPa.
void refer(Frf& frf, double distance)
{
    for (auto& value : frf.value)
        value *= sheetVoltage * distance / referencePressure;
    frf.noiseVariance.clear();  // no file of a curve has them
    frf.totalVariance.clear();
}

}  // namespace

std::vector<double> curveFrequencies(double low, double high, double pointsPerOctave)
{
    if (!(low > 0.0 && high > low && std::isfinite(high)))
        throw Error(Error::Kind::usage, "The band must be two frequencies in Hz, the lower one first.");
    const auto steps = static_cast<int>(std::ceil(pointsPerOctave * std::log2(high / low)));
    std::vector<double> frequency;
    for (int k = 0; k < steps; ++k)
        frequency.push_back(low * std::pow(high / low, static_cast<double>(k) / steps));
    frequency.push_back(high);
    return frequency;
}

Frf impedanceCurve(const Model& model, const std::vector<double>& frequency)
{
    requireCoil(model.electrical());
    Frf frf {frequency, respond(withoutSensors(model), {Quantity::current}, frequency).front().value, {}, {}};
    for (auto& value : frf.value)
        value = 1.0 / value;
    return frf;
}

Frf soundCurve(const ScaledModel& given, const std::vector<double>& frequency)
{
    const auto& model = given.model;
    requireCoil(model.electrical());
    // then both are a guess alike, and the sound was measured
    const bool followsArea = model.path.parameters[0].free;
    if (given.motionIsGuessed && !followsArea)
        throw Error(Error::Kind::data, "The take shows neither the sound nor the moving mass, so the sound cannot be "
                                       "told; give the mass or Bl, and the area of the cone.");
    if (given.areaIsGuessed)
        throw Error(Error::Kind::data,
                    "The take does not tell the area of the cone, so the sound cannot be told; give it.");
    Frf frf {frequency, respond(withoutSensors(model), {Quantity::pressure}, frequency).front().value, {}, {}};
    const double flight = model.path.parameters[1].value;
    for (std::size_t k = 0; k < frequency.size(); ++k)
        frf.value[k] *= std::polar(1.0, 2.0 * std::numbers::pi * frequency[k] * flight);
    refer(frf, model.microphoneDistance);
    return frf;
}

Measurement playedAt(const Model& model, double level, double low, double high, const Progress& progress)
{
    requireCoil(model.electrical());
    ExcitationPlanOptions plan;
    plan.multisine.sampleRate = 16000.0;
    while (plan.multisine.sampleRate < 2.5 * high)
        plan.multisine.sampleRate *= 2.0;
    constexpr double linesBelow = 8.0, longest = 1 << 20;
    double period = 1024.0;
    while (period < longest && period < linesBelow * plan.multisine.sampleRate / low)
        period *= 2.0;
    plan.multisine.period = static_cast<int>(period);
    plan.multisine.bandLow = low;
    plan.multisine.bandHigh = high;
    plan.levels = {level};
    plan.settlePeriods = 2;
    plan.periods = 1;
    auto take = planExcitation(plan);
    const auto excitation = take.excitation;
    take = simulate(model, take.channels.front().samples, plan.multisine.sampleRate, {}, nullptr, progress);
    take.excitation = excitation;
    take.driver.microphoneDistance = model.microphoneDistance;
    return take;
}

Frf impedanceCurve(const Measurement& take, double level)
{
    requireChannel(take, Quantity::current);
    return bla(take, Quantity::voltage, levelNear(take, level), Quantity::current).frf;
}

Frf soundCurve(const Measurement& take, double level)
{
    requireChannel(take, Quantity::pressure);
    if (!take.driver.microphoneDistance)
        throw Error(Error::Kind::data, "The take does not tell the distance of the microphone "
                                       "(driver.microphoneDistance), so its sound at 1 m cannot be told.");
    auto frf = bla(take, Quantity::pressure, levelNear(take, level)).frf;
    refer(frf, *take.driver.microphoneDistance);
    return frf;
}

}  // namespace excursion
