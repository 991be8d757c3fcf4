// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Effect.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace excursion {

const Parameter& parameterNamed(const std::vector<Parameter>& parameters, std::string_view name)
{
    const auto found = std::find_if(parameters.begin(), parameters.end(),
                                    [&](const Parameter& p) { return p.name == name; });
    if (found == parameters.end())
        throw std::out_of_range("no parameter " + std::string(name));
    return *found;
}

double resonanceOf(const std::vector<Parameter>& base)
{
    return std::sqrt(parameterNamed(base, "K").value / parameterNamed(base, "m").value) / (2.0 * std::numbers::pi);
}

std::vector<std::vector<double>> Effect::starts(const OperatingRange& operatingRange) const
{
    std::vector<double> values;
    for (const auto& parameter : parameters(operatingRange))
        values.push_back(parameter.strength ? 0.0 : parameter.value);
    return {values};
}

std::vector<Part> Effect::parts(const OperatingRange&) const { return {}; }

void Effect::follow(const OperatingRange&, const double*, double*) const {}

std::vector<Restart> Effect::restarts(const OperatingRange&, const std::vector<double>&,
                                      const std::vector<Parameter>&) const
{
    return {};
}

bool Effect::plausible(const OperatingRange&, const std::vector<Parameter>&, const std::vector<Parameter>&) const
{
    return true;
}

std::vector<Figure> Effect::summary(const OperatingRange&, const double*) const { return {}; }

std::string Effect::sizedBy() const
{
    const auto info = law();
    return info ? info->base : "";
}

double Effect::lawAt(const OperatingRange&, const double*, double) const { return 0.0; }

double Effect::delayedLawAt(const OperatingRange&, const double*, double, double) const { return 0.0; }

double Effect::addsTo(std::string_view, const OperatingRange&, const double*, double) const { return 0.0; }

}  // namespace excursion
