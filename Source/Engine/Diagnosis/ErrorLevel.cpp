// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/ErrorLevel.h"

#include <algorithm>
#include <cmath>

namespace excursion {

double powerRatioDb(double power, double reference)
{
    return 10.0 * std::log10(std::max(power, 1e-300) / std::max(reference, 1e-300));
}

bool isNoise(const ErrorLevel& error)
{
    constexpr double mostLines = 1.6, mostDb = 3.0;  // 2 dB of mean squared error over the noise's
    constexpr double sure = 9.0;                     // squared: three standard errors
    return error.noiseFloorDb && error.chiSquaredPerValue <= mostLines + sure * error.openChiSquared
           && error.db
                  <= *error.noiseFloorDb + 10.0 * std::log10(std::pow(10.0, 0.1 * mostDb) + sure * error.openPower);
}

ErrorLevel levelOf(const ErrorSums& sums, bool noiseKnown)
{
    ErrorLevel level;
    const double rows = std::max(1.0, sums.rows);
    level.db = powerRatioDb(sums.power.error, sums.power.measured);
    level.chiSquaredPerValue = sums.cost / rows;
    if (!noiseKnown)
        return level;
    level.noiseFloorDb = powerRatioDb(sums.power.noise, sums.power.measured);
    level.openChiSquared = sums.open.chiSquared / rows;
    if (sums.power.noise > 0.0)
        level.openPower = sums.open.power / sums.power.noise;
    return level;
}

}  // namespace excursion
