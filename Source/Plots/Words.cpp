// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plots/Words.h"

#include "Engine/Loudspeaker/Catalogue.h"

#include <algorithm>
#include <cmath>

namespace excursion {

std::string effectTitle(const std::string& id)
{
    for (const auto* effect : catalogue())
        if (effect->id() == id)
            return effect->title();
    return id;
}

std::string rungTitle(const Ladder& ladder, std::size_t rung)
{
    const auto& added = ladder.rungs.at(rung).added;
    return std::to_string(rung) + " \u00b7 " + (added.empty() ? std::string("first model") : effectTitle(added));
}

std::string capitalized(std::string_view text)
{
    std::string result(text);
    if (!result.empty() && result[0] >= 'a' && result[0] <= 'z')
        result[0] = static_cast<char>(result[0] - 'a' + 'A');
    return result;
}

std::vector<double> scaled(const std::vector<double>& values, double factor)
{
    auto result = values;
    for (auto& value : result)
        value *= factor;
    return result;
}

double largest(const std::vector<double>& values)
{
    double most = 0.0;
    for (const double value : values)
        if (std::isfinite(value))
            most = std::max(most, std::abs(value));
    return most;
}

}  // namespace excursion
