// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/Model.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace excursion {

inline constexpr double xmax = 4e-3;  ///< m, of midbass()
inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// The dissertation's driver.
inline Model midbass()
{
    auto model = makeModel("electrodynamic");
    const std::pair<const char*, double> base[] {{"Re", 3.3},    {"Le", 266e-6}, {"Bl", 4.95},
                                                 {"m", 0.01435}, {"Rms", 0.786}, {"K", 1852.0}};
    for (const auto& [name, value] : base)
        model.baseParameter(name).value = value;
    return model;
}

/// The effect in the model, strong and not symmetric: laws change by some 25 % over xmax.
inline Model withStrong(const Model& plain, const Effect& effect)
{
    OperatingRange operatingRange;
    operatingRange.displacement = xmax;
    operatingRange.velocity = 2.0;
    operatingRange.current = 10.0;
    operatingRange.lowFrequency = 15.0;
    operatingRange.highFrequency = 8000.0;
    auto model = withEffect(plain, effect, operatingRange);
    auto& added = model.components.back();
    if (const auto law = effect.law()) {
        // d(Le i)/di falls thrice as far as Le(i)
        const bool rises = law->base == "K" || law->base == "Rms", flux = law->argument == "i";
        added.parameters[0].value = (rises ? 0.05 : flux ? -0.02 : -0.06) * added.operatingRange.scale;
        added.parameters[1].value = (rises ? 0.25 : flux ? -0.03 : -0.2) * added.operatingRange.scale;
    } else {
        for (auto& parameter : added.parameters)
            if (parameter.strength && !parameter.heard)
                parameter.value = std::isfinite(parameter.prior)   ? 0.1 * parameter.prior
                                  : std::isfinite(parameter.upper) ? 0.1 * parameter.upper
                                  : effect.electrical()            ? 0.02
                                                                   : 300.0;
    }
    return model;
}

/// All that predistortion takes out, and linear effects that are felt.
inline Model everything()
{
    auto model = midbass();
    for (const auto* effect : catalogue())
        if (effect->undone())
            model = withStrong(model, *effect);
    return model;
}

/// Two tones under a bell: starts and ends in silence and is far from half the sample rate.
inline std::vector<double> burst(double sampleRate, double seconds, double amplitude)
{
    std::vector<double> u(static_cast<std::size_t>(seconds * sampleRate));
    for (std::size_t n = 0; n < u.size(); ++n) {
        const double t = static_cast<double>(n) / sampleRate, bell = (t - 0.5 * seconds) / (0.1 * seconds);
        u[n] = amplitude * std::exp(-0.5 * bell * bell)
               * (std::sin(2.0 * std::numbers::pi * 60.0 * t) + 0.3 * std::sin(2.0 * std::numbers::pi * 910.0 * t));
    }
    return u;
}

inline std::vector<double> noise(std::size_t length, double amplitude, unsigned seed = 1)
{
    std::mt19937_64 random(seed);
    std::vector<double> u(length);
    for (auto& sample : u)
        sample = amplitude * (2.0 * static_cast<double>(random() >> 11) * 0x1p-53 - 1.0);
    return u;
}

/// All of u through an engine, in blocks of 64, without its latency.
template <class Engine>
std::vector<double> through(Engine& engine, const std::vector<double>& u)
{
    auto in = u;
    in.resize(u.size() + static_cast<std::size_t>(engine.latency()), 0.0);
    for (std::size_t n = 0; n < in.size(); n += 64)
        engine.process(in.data() + n, in.data() + n, std::min<std::size_t>(64, in.size() - n));
    in.erase(in.begin(), in.begin() + engine.latency());
    return in;
}

inline double rms(const std::vector<double>& values)
{
    double sum = 0.0;
    for (const double value : values)
        sum += value * value;
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(values.size(), 1)));
}

/// ||a - b|| / ||b||
inline double relativeError(const std::vector<double>& a, const std::vector<double>& b)
{
    std::vector<double> difference(b.size());
    for (std::size_t n = 0; n < b.size(); ++n)
        difference[n] = a[n] - b[n];
    return rms(difference) / rms(b);
}

inline double peak(const std::vector<double>& values)
{
    double result = 0.0;
    for (const double value : values)
        result = std::max(result, std::abs(value));
    return result;
}

}  // namespace excursion
