// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/TakeRecords.h"

#include "Engine/Measurement/Periods.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

Eigen::MatrixXd columnOf(std::span<const double> samples)
{
    return Eigen::Map<const Eigen::VectorXd>(samples.data(), static_cast<Eigen::Index>(samples.size()));
}

} // namespace

PnlssRecords recordsOf(const Measurement& take, const Channel& input, const Channel& output, int wantedLevel)
{
    PnlssRecords records;
    if (!take.excitation || take.excitation->lines.empty()) {
        const auto N = static_cast<Eigen::Index>(take.length()), cut = N * 2 / 3;
        const auto u = columnOf(input.samples), y = columnOf(output.samples);
        const Eigen::Index skip = std::min<Eigen::Index>(1000, N / 10);
        records.estimation.push_back({u.topRows(cut), y.topRows(cut), skip, false});
        records.validation.push_back({u.bottomRows(N - cut), y.bottomRows(N - cut), skip, false});
        return records;
    }
    const auto& excitation = periodicExcitation(take);
    // Long enough for the slowest pole of a loudspeaker, which a few thousand samples at a high rate are not.
    const auto before = std::max<Eigen::Index>(std::min(excitation.period, 4096), std::lround(0.2 * take.sampleRate));
    const int level = wantedLevel >= 0 ? wantedLevel : static_cast<int>(excitation.levels.size()) - 1;
    for (int r = 0; r < excitation.realizations; ++r) {
        const auto record = periodicRecord(columnOf(averagePeriod(take, input, level, r)), columnOf(averagePeriod(take, output, level, r)), before);
        const bool last = excitation.realizations > 1 && r + 1 == excitation.realizations;
        (last ? records.validation : records.estimation).push_back(record);
    }
    return records;
}

} // namespace excursion
