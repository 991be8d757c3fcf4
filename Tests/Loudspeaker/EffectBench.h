// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Catalogue.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace excursion {

/// What a midbass visits, for an effect whose law bends a parameter of the size `scale`.
inline OperatingRange someOperatingRange(double scale)
{
    OperatingRange operatingRange;
    operatingRange.displacement = 4e-3;
    operatingRange.velocity = 1.2;
    operatingRange.current = 6.0;
    operatingRange.lowFrequency = 15.0;
    operatingRange.highFrequency = 8000.0;
    operatingRange.scale = scale;
    operatingRange.duration = 0.1;  // slow memories have settled within a second
    return operatingRange;
}

/// The size of the parameter that the effect bends or stands beside: that of a midbass.
inline double someScale(const Effect& effect)
{
    const auto base = effect.sizedBy();
    if (base.empty())
        return effect.electrical() || !effect.felt() ? 0.02 : 1800.0;
    return base == "Re"   ? 3.3
           : base == "Bl" ? 5.0
           : base == "K"  ? 1800.0
           : base == "Le" ? 3e-4
           : base == "m"  ? 0.014
                          : 0.8;
}

/// What makes a strength strong: a share of what is plausible, where the effect says what that is, else of its scale.
inline double strengthOf(const Effect& effect, const Parameter& p, const OperatingRange& operatingRange, double share)
{
    return share * std::min(effect.law() || !std::isfinite(p.prior) ? operatingRange.scale : p.prior, p.upper);
}

/// One effect on its own, with parameters that make it strong, and its host's behind them, asked at any state.
struct Alone {
    explicit Alone(const Effect& which) : effect(which), operatingRange(someOperatingRange(someScale(which)))
    {
        double sign = 1.0;
        for (const auto& p : effect.parameters(operatingRange)) {
            const double strength = p.lower == 0.0 ? 0.3 : 0.1 * (sign *= -1.0);
            parameters.push_back(p.strength ? strengthOf(effect, p, operatingRange, strength) : p.value);
        }
        if (const auto* host = effect.host())
            for (const auto& p : host->parameters(operatingRange)) {
                operatingRange.host.push_back(p.strength ? strengthOf(*host, p, operatingRange, 0.3) : p.value);
                parameters.push_back(operatingRange.host.back());
            }
        prepare();
    }

    void prepare()
    {
        coefficients.assign(static_cast<std::size_t>(effect.coefficientCount(operatingRange)), 0.0);
        effect.prepare(operatingRange, parameters.data(), coefficients.data());
    }

    std::vector<double> rest() const
    {
        return std::vector<double>(static_cast<std::size_t>(effect.memorySize(operatingRange)), 0.0);
    }

    /// @param rate  the memory's rates; may be null
    Balance<double> at(double i, double x, double v, const std::vector<double>& memory,
                       std::vector<double>* rate = nullptr) const
    {
        thread_local std::vector<double> unused;
        unused.resize(memory.size());
        Balance<double> sum;
        effect.contribute(operatingRange, coefficients.data(), {i, x, v}, memory.data(),
                          rate ? rate->data() : unused.data(), sum);
        return sum;
    }
    Balance<double> at(double i, double x, double v) const { return at(i, x, v, rest()); }

    const Effect& effect;
    OperatingRange operatingRange;
    std::vector<double> parameters, coefficients;
};

/// Points all over what is visited: current, displacement, velocity.
inline std::vector<std::array<double, 3>> somePoints(const OperatingRange& e)
{
    std::vector<std::array<double, 3>> points;
    for (const double x : {-0.83, -0.31, 0.12, 0.77})
        for (const double i : {-0.9, 0.4, 0.7})
            for (const double v : {-0.6, 0.25})
                points.push_back({i * e.current, x * e.displacement, v * e.velocity});
    return points;
}

}  // namespace excursion
