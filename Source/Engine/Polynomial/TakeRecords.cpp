// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/TakeRecords.h"

#include "Engine/Estimate/Periods.h"
#include "Engine/Signal/Level.h"

#include <algorithm>
#include <cmath>
#include <complex>

namespace excursion {
namespace {

Eigen::MatrixXd columnOf(std::span<const double> samples)
{
    return Eigen::Map<const Eigen::VectorXd>(samples.data(), static_cast<Eigen::Index>(samples.size()));
}

/// Of the output's periods around their mean, summed over all samples, as far as it does not follow the input's
/// scatter: Y_p - G U_p, G = Ybar/Ubar (see Estimate/Bla.h). Between two excited lines G is what lies between theirs;
/// beyond them it is not known, and the output's scatter counts as it is. The mean, line 0, is left out.
double scatterOf(const Measurement& take, const Channel& input, const Channel& output, int level, int realization)
{
    using Complex = std::complex<double>;
    const auto U = periodSpectra(take, input, level, realization), Y = periodSpectra(take, output, level, realization);
    const auto meanU = averageOf(U).mean, meanY = averageOf(Y).mean;
    const std::size_t lines = meanY.size();
    std::vector<Complex> G(lines, 0.0);
    std::optional<std::size_t> last;
    for (const int line : excitedLines(take)) {
        const auto k = static_cast<std::size_t>(line);
        if (std::norm(meanU[k]) == 0.0)
            continue;
        G[k] = meanY[k] / meanU[k];
        for (std::size_t between = last.value_or(k) + 1; between < k; ++between)
            G[between] = G[*last]
                         + (G[k] - G[*last]) * static_cast<double>(between - *last) / static_cast<double>(k - *last);
        last = k;
    }
    const int N = take.excitation->period;
    double scatter = 0.0;
    for (std::size_t p = 0; p < Y.size(); ++p)
        for (std::size_t k = 1; k < lines; ++k) {
            const bool nyquist = 2 * k == static_cast<std::size_t>(N);
            scatter += (nyquist ? 1.0 : 2.0) * std::norm(Y[p][k] - meanY[k] - G[k] * (U[p][k] - meanU[k])) / N;
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
    // Long enough for a resonance of a high Q, which a few thousand samples at a high rate are not.
    const auto before = std::max<Eigen::Index>(
        std::min<Eigen::Index>(excitation.period, std::lround(2.0 * take.sampleRate)),
        std::lround(0.2 * take.sampleRate));
    const int level = excitation.levelOf(wantedLevel);
    double scatter = 0.0, power = 0.0;
    for (int r = 0; r < excitation.realizations; ++r) {
        const auto mean = averagePeriod(take, output, level, r);
        if (excitation.periods > 1)
            scatter += scatterOf(take, input, output, level, r);
        power += (columnOf(mean).array() - columnOf(mean).mean()).matrix().squaredNorm();
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
