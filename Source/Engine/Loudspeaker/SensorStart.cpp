// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/SensorStart.h"

#include "Engine/Loudspeaker/SmallSignal.h"

#include <algorithm>
#include <array>
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

void expect(Parameter& p, double prior, bool isSigned)
{
    constexpr double most = 10.0;  // times the prior
    p.free = true;
    p.prior = prior;
    p.upper = most * prior;
    p.lower = isSigned ? -p.upper : 0.0;
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
    constexpr double turn = 0.05;     // rad; of the prior
    constexpr double farAbove = 4.0;  // times the end of the band
    // Beyond two equal poles a corner becomes a lag of first order and no place of T.
    constexpr double lowestDamping = 0.1, highestDamping = 2.0;
    const bool told = hasPeriods(record) && record.noiseKnown && record.bandLow > 0.0;
    for (const auto quantity :
         {Quantity::current, Quantity::displacement, Quantity::velocity, Quantity::acceleration}) {
        std::vector<Parameter*> own;
        for (const auto place : sensorPlaces(quantity))
            own.push_back(&model.path.parameters[static_cast<std::size_t>(place)]);
        for (auto* p : own)
            p->free = false;
        if (!told || !record.channelIndex(quantity))
            continue;
        const double end = 2.0 * std::numbers::pi * record.bandHigh;
        // Displacement and velocity fall off with frequency.
        const bool falls = quantity == Quantity::displacement || quantity == Quantity::velocity;
        expect(*own[0], turn / (falls ? end * std::sqrt(record.bandLow / record.bandHigh) : end), true);
        if (own.size() == 1 || !record.channelIndex(Quantity::current))
            continue;
        expect(*own[1], 1.0 / end, false);
        own[2]->free = true;
        own[2]->lower = lowestDamping;
        own[2]->upper = highestDamping;
        if (own[1]->value != 0.0)
            continue;
        // There nothing changes with either.
        const auto begin = cornerOf(model, linearResponsesOf(record), quantity)
                               .value_or(withCorner(farAbove * end, std::numbers::sqrt2));
        const std::array values {own[0]->value == 0.0 ? begin.lag : own[0]->value, begin.T, begin.q};
        for (std::size_t k = 0; k < own.size(); ++k)
            own[k]->value = std::clamp(values[k], own[k]->lower, own[k]->upper);
    }
}

}  // namespace excursion
