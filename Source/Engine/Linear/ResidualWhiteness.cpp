// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/ResidualWhiteness.h"

#include "Engine/Linear/Response.h"

namespace excursion {

bool leavesWhiteNoise(const PartialFractionFit& fit, const FrequencyData& data)
{
    using Eigen::Index;
    constexpr Index lags = 5;
    constexpr double chance = 15.0;  // a sum of five exponential variables exceeds it once in 1000
    const auto n = fit.sections.order(), K = data.lines();
    if (K < 4 * n || K < 20)
        return false;
    const Eigen::MatrixXcd basis = partialFractions(
        fit.sections, evaluationPoints(data.frequency, fit.sections.sampleRate, fit.sections.alpha));
    const Eigen::MatrixXd weights = weightsOf(data);
    const double lines = static_cast<double>(K), order = static_cast<double>(n);
    for (Index o = 0; o < data.outputs; ++o) {
        Eigen::VectorXcd rest = Eigen::VectorXcd::Constant(K, fit.D[o]) - data.value.col(o);
        for (Index j = 0; j < n; ++j)
            rest += fit.C(o, j) * basis.col(j);
        rest = rest.cwiseProduct(weights.col(o)).eval();
        const double power = rest.squaredNorm();
        double sum = 0.0;
        for (Index lag = 1; lag <= lags; ++lag)
            sum += std::norm(rest.tail(K - lag).dot(rest.head(K - lag)));
        if (!(lines * sum <= (chance + static_cast<double>(lags) * order * order / lines) * power * power))
            return false;
    }
    return true;
}

}  // namespace excursion
