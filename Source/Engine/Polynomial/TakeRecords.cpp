// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/TakeRecords.h"

#include "Engine/Estimate/Periods.h"
#include "Engine/Signal/Level.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

Eigen::MatrixXd columnOf(std::span<const double> samples)
{
    return Eigen::Map<const Eigen::VectorXd>(samples.data(), static_cast<Eigen::Index>(samples.size()));
}

/// Of all periods of a realization around their mean, summed.
double scatterOf(const Measurement& take, const Channel& output, int level, int realization,
                 const std::vector<double>& mean)
{
    double scatter = 0.0;
    for (int p = 0; p < take.excitation->periods; ++p) {
        const auto period = onePeriod(take, output, level, realization, p);
        for (std::size_t t = 0; t < mean.size(); ++t)
            scatter += std::pow(period[t] - mean[t], 2);
    }
    return scatter;
}

}  // namespace

InputOutputRecords recordsOf(const Measurement& take, const Channel& input, const Channel& output, int wantedLevel)
{
    InputOutputRecords records;
    if (!take.hasPeriods()) {
        const auto N = static_cast<Eigen::Index>(take.length()), cut = N * 2 / 3;
        const auto u = columnOf(input.samples), y = columnOf(output.samples);
        const Eigen::Index skip = std::min<Eigen::Index>(1000, N / 10);
        records.estimation.push_back({u.topRows(cut), y.topRows(cut), skip, false});
        records.validation.push_back({u, y, cut, false, 0});  // led in by all that comes before
        return records;
    }
    const auto& excitation = periodicExcitation(take);
    // Long enough for the slowest pole of a loudspeaker, which a few thousand samples at a high rate are not.
    const auto before = std::max<Eigen::Index>(std::min(excitation.period, 4096), std::lround(0.2 * take.sampleRate));
    const int level = excitation.levelOf(wantedLevel);
    double scatter = 0.0, power = 0.0;
    for (int r = 0; r < excitation.realizations; ++r) {
        const auto mean = averagePeriod(take, output, level, r);
        scatter += scatterOf(take, output, level, r, mean);
        power += columnOf(mean).squaredNorm();
        const auto record = periodicRecord(columnOf(averagePeriod(take, input, level, r)), columnOf(mean), before);
        const bool last = excitation.realizations > 1 && r + 1 == excitation.realizations;
        (last ? records.validation : records.estimation).push_back(record);
    }
    if (const double P = excitation.periods; P > 1.0)
        // the variance of the means over their power
        records.noiseDb = decibelsOf(scatter / (P * (P - 1.0)) / power);
    return records;
}

}  // namespace excursion
