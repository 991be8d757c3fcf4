// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/Effect.h"

namespace excursion {

std::vector<std::vector<double>> Effect::starts(const Extent& extent) const
{
    std::vector<double> values;
    for (const auto& parameter : parameters(extent))
        values.push_back(parameter.strength ? 0.0 : parameter.value);
    return {values};
}

std::vector<Part> Effect::parts(const Extent&) const { return {}; }

std::vector<double> Effect::restarts(const Extent&, const std::vector<double>&) const { return {}; }

bool Effect::plausible(const Extent&, const std::vector<Parameter>&, const std::vector<Parameter>&) const { return true; }

std::vector<Figure> Effect::summary(const Extent&, const double*) const { return {}; }

std::string Effect::sizedBy() const
{
    const auto info = law();
    return info ? info->base : "";
}

double Effect::lawAt(const Extent&, const double*, double) const { return 0.0; }

} // namespace excursion
