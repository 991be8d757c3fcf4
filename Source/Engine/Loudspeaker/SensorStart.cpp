// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/SensorStart.h"

#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Take/Motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace excursion {
namespace {

using Complex = std::complex<double>;

/// ln of what is measured over what the model says.
struct Ratio {
    Complex s, log;
    double weight;
};

const ResponseTarget* targetOf(const std::vector<ResponseTarget>& targets, Quantity quantity)
{
    const auto found = std::find_if(targets.begin(), targets.end(),
                                    [&](const ResponseTarget& t) { return t.quantity == quantity && !t.impedance; });
    return found != targets.end() ? &*found : nullptr;
}

/// Of the motion to the current.
std::vector<Ratio> ratios(const Model& model, const ResponseTarget& motion, const ResponseTarget& current)
{
    constexpr double sure = 5.0;       // deviations
    constexpr double modelled = 0.05;  // of the value: no base is better before it is fitted
    const auto played = respond(withoutSensors(model), {motion.quantity, Quantity::current}, motion.frequency);
    std::vector<Ratio> result;
    for (std::size_t k = 0; k < motion.frequency.size(); ++k) {
        const auto at = std::find(current.frequency.begin(), current.frequency.end(), motion.frequency[k]);
        const double noise = motion.deviation[k] / std::abs(motion.value[k]);
        if (at == current.frequency.end() || noise * sure > 1.0)
            continue;
        const auto i = current.value[static_cast<std::size_t>(at - current.frequency.begin())];
        result.push_back({Complex(0.0, 2.0 * std::numbers::pi * motion.frequency[k]),
                          std::log(motion.value[k] / i * played[1].value[k] / played[0].value[k]),
                          1.0 / (noise * noise + modelled * modelled)});
    }
    return result;
}

/// A fit of a factor and a lag to what a corner leaves.
struct Left {
    double cost, lag;
};

Left leftBy(const SensorResponse& corner, const std::vector<Ratio>& ratios)
{
    double weights = 0.0, reals = 0.0, ww = 0.0, wy = 0.0;
    std::vector<Complex> left;
    for (const auto& r : ratios) {
        auto y = r.log - std::log(corner(r.s));
        y.imag(std::remainder(y.imag(), 2.0 * std::numbers::pi));
        left.push_back(y);
        const double w = r.s.imag();
        weights += r.weight;
        reals += r.weight * y.real();
        ww += r.weight * w * w;
        wy += r.weight * w * y.imag();
    }
    const double gain = reals / weights, turn = wy / ww;
    double cost = 0.0;
    for (std::size_t k = 0; k < ratios.size(); ++k)
        cost += ratios[k].weight * std::norm(left[k] - Complex(gain, turn * ratios[k].s.imag()));
    return {cost, -turn};
}

SensorResponse withCorner(double omega, double q) { return {.T = 1.0 / omega, .q = q}; }

Parameter& parameterOf(Model& model, const SensorParameter& p)
{
    return model.path.parameters[static_cast<std::size_t>(p.place)];
}

constexpr double most = 10.0;  // times the prior

void expect(Parameter& p, double prior, double lower)
{
    p.free = true;
    p.prior = prior;
    p.lower = lower;
    p.upper = most * prior;
    p.value = std::clamp(p.value, p.lower, p.upper);  // of another take it may be outside
}

/// Displacement and velocity fall off with frequency.
bool falls(Quantity quantity) { return quantity == Quantity::displacement || quantity == Quantity::velocity; }

void freeLag(Parameter& lag, const Record& record, Quantity quantity)
{
    constexpr double turn = 0.05;  // rad; of the prior
    const double highest = falls(quantity) ? std::sqrt(record.bandLow * record.bandHigh) : record.bandHigh;
    const double prior = turn / (2.0 * std::numbers::pi * highest);
    expect(lag, prior, -most * prior);
}

void freeCorner(Model& model, const Record& record, Quantity motion)
{
    constexpr double farAbove = 4.0;  // times the end of the band
    // Beyond two equal poles a corner becomes a lag of first order and no place of T.
    constexpr double lowestDamping = 0.1, highestDamping = 2.0;
    const auto own = sensorParameters(motion);
    auto &lag = parameterOf(model, own[0]), &T = parameterOf(model, own[1]), &q = parameterOf(model, own[2]);
    const double end = 2.0 * std::numbers::pi * record.bandHigh;
    expect(T, 1.0 / end, 0.0);
    q.free = true;
    q.lower = lowestDamping;
    q.upper = highestDamping;
    if (T.value != 0.0) {
        q.value = std::clamp(q.value, q.lower, q.upper);
        return;
    }
    // There nothing changes with either.
    const auto begin =
        cornerOf(model, linearResponsesOf(record), motion).value_or(withCorner(farAbove * end, std::numbers::sqrt2));
    if (lag.value == 0.0)
        lag.value = std::clamp(begin.lag, lag.lower, lag.upper);
    T.value = std::min(begin.T, T.upper);
    q.value = begin.q;
}

void freeRollOff(Model& model, const Record& record)
{
    constexpr double error = 0.1;  // of the corner
    const auto own = sensorParameters(Quantity::pressure);
    auto &rolledOff = parameterOf(model, own[0]), &further = parameterOf(model, own[1]);
    const double corner = 2.0 * std::numbers::pi * record.microphoneCorner, before = rolledOff.value;
    rolledOff.value = corner;
    if (corner == 0.0) {
        further.value = 0.0;
        return;
    }
    expect(further, error * corner, -0.5 * corner);
    if (before != corner)  // of another take of the same microphone, or not known yet
        further.value = std::clamp(before > 0.0 ? further.value + before - corner : 0.0, further.lower, further.upper);
}

}  // namespace

std::optional<SensorResponse> cornerOf(const Model& model, const std::vector<ResponseTarget>& targets, Quantity motion)
{
    const auto *moved = targetOf(targets, motion), *current = targetOf(targets, Quantity::current);
    if (!moved || !current)
        return std::nullopt;
    const auto told = ratios(model, *moved, *current);
    constexpr std::size_t fewest = 8;  // ratios
    if (told.size() < fewest)
        return std::nullopt;
    constexpr double least = 0.3;  // of what is left without a corner
    double lowest = least * leftBy({}, told).cost;
    std::optional<SensorResponse> best;
    const double end = told.back().s.imag(), begin = std::sqrt(end * told.front().s.imag());
    for (double omega = 4.0 * end; omega > begin; omega /= std::cbrt(2.0))
        for (const double q : {0.5, 1.0, 1.4, 1.7, 2.0}) {
            auto corner = withCorner(omega, q);
            const auto left = leftBy(corner, told);
            if (left.cost < lowest) {
                lowest = left.cost;
                corner.lag = left.lag;
                best = corner;
            }
        }
    return best;
}

void freeSensors(Model& model, const Record& record)
{
    const bool told = hasPeriods(record) && record.noiseKnown && record.bandLow > 0.0;
    const bool besideCurrent = record.channelIndex(Quantity::current).has_value();
    for (const auto quantity :
         {Quantity::current, Quantity::displacement, Quantity::velocity, Quantity::acceleration, Quantity::pressure}) {
        for (const auto& p : sensorParameters(quantity))
            parameterOf(model, p).free = false;
        if (!told || !record.channelIndex(quantity))
            continue;
        if (quantity != Quantity::pressure)
            freeLag(parameterOf(model, sensorParameters(quantity).front()), record, quantity);
        if (isMotion(quantity) && besideCurrent)
            freeCorner(model, record, quantity);
        if (quantity == Quantity::pressure && besideCurrent)
            freeRollOff(model, record);
    }
}

}  // namespace excursion
