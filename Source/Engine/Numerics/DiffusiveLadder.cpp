// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/DiffusiveLadder.h"

#include "Engine/Error.h"
#include "Engine/Numerics/LadderCells.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion {

using Complex = std::complex<double>;
using std::numbers::pi;

Complex DiffusiveLadder::power(Complex s) const
{
    Complex sum = resistance + inductance * s;
    for (Eigen::Index k = 0; k < cells(); ++k)
        sum += resistances[k] * s / (s + rates[k]);
    return sum;
}

bool DiffusiveLadderOptions::isValid(std::string* reason) const
{
    const bool valid = lowFrequency > 0.0 && highFrequency > lowFrequency && std::isfinite(highFrequency)
                       && cellsPerDecade >= 0.5 && cellsPerDecade <= 8.0;
    return valid
           || refuse(
               reason,
               "a ladder needs a band that begins above 0 Hz and ends above its begin, and 0.5 to 8 cells a decade");
}

DiffusiveLadder ladderFor(double exponent, const DiffusiveLadderOptions& options)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "There is no such ladder: " + reason + ".");
    if (!(exponent > 0.0 && exponent < 1.0))
        throw Error(Error::Kind::usage,
                    "A ladder realizes powers between 0 and 1, not " + std::to_string(exponent) + ".");
    const double step = std::log(10.0) / options.cellsPerDecade;
    // A decade beyond the band gains some 4 decades of accuracy, and the rule itself has pi^2/step nepers.
    const double margin = pi * pi / step / 3.5;
    const double low = std::log(2.0 * pi * options.lowFrequency) - margin,
                 high = std::log(2.0 * pi * options.highFrequency) + margin;
    const auto inner = static_cast<Eigen::Index>(std::ceil((high - low) / step));
    const double start = 0.5 * (low + high - step * static_cast<double>(inner - 1));

    DiffusiveLadder ladder;
    ladder.exponent = exponent;
    ladder.rates.resize(inner + 2);
    for (Eigen::Index k = 0; k < inner; ++k)
        ladder.rates[k + 1] = std::exp(start + step * static_cast<double>(k));
    const auto below = ladderBelow(start - step, exponent, step),
               above = ladderAbove(start + step * static_cast<double>(inner), exponent, step);
    ladder.rates[0] = below.rate;
    ladder.rates[inner + 1] = above.rate;
    ladder.resistances = ladder.rates.array().pow(exponent);
    ladder.resistances[0] = below.resistance;
    ladder.resistances[inner + 1] = above.resistance;
    const double factor = ladderFactor(1.0, exponent, step);
    ladder.resistances *= factor;
    ladder.resistance = factor * below.constant;
    ladder.inductance = factor * above.constant;
    return ladder;
}

}  // namespace excursion
