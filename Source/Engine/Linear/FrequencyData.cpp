// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/FrequencyData.h"

#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {

using Eigen::Index;

namespace {

bool isTold(double variance) { return variance > 0.0 && std::isfinite(variance); }

/// On how many lines a variance must be told together to be known to 20 %, by how much it jumps from line to line: the
/// logarithm of one that so many realizations (or periods) tell scatters by their number alone. The noise itself may be
/// steep, so the jump is that from the line between two others to their middle.
std::size_t linesToShare(const std::vector<double>& variance)
{
    constexpr double enough = 24.0;  // degrees of freedom
    std::vector<double> jumps;
    for (std::size_t k = 1; k + 1 < variance.size(); ++k)
        if (isTold(variance[k - 1]) && isTold(variance[k]) && isTold(variance[k + 1]))
            jumps.push_back(
                std::pow(std::log(variance[k - 1] / variance[k]) + std::log(variance[k + 1] / variance[k]), 2));
    if (jumps.empty())
        return static_cast<std::size_t>(enough);
    const auto middle = jumps.begin() + static_cast<std::ptrdiff_t>(jumps.size() / 2);
    std::nth_element(jumps.begin(), middle, jumps.end());
    // The median of the square of a normal number is 0.455, and the jump has 6 times the variance of one logarithm.
    const double scatter = *middle / (6.0 * 0.455), freedom = 0.5 + 1.0 / std::max(scatter, 1e-6);
    return static_cast<std::size_t>(std::ceil(enough / freedom));
}

/// The scatter of a few realizations tells the noise of a line only roughly, and a line that it makes too quiet by
/// chance would weigh too much. So neighbouring lines share theirs; one that sticks out (hum) keeps its own. Where it
/// is known well, nothing changes.
std::vector<double> smoothed(const std::vector<double>& raw)
{
    const std::size_t share = linesToShare(raw), count = raw.size();
    if (share < 2)
        return raw;
    auto result = raw;
    for (std::size_t k = 0; k < count; ++k) {
        double sum = 0.0;
        std::size_t lines = 0;
        const auto add = [&](std::size_t line) {
            if (std::isfinite(raw[line]) && raw[line] >= 0.0) {
                sum += raw[line];
                ++lines;
            }
        };
        add(k);
        for (std::size_t reach = 1; lines < share && reach < count; ++reach) {
            if (reach <= k)
                add(k - reach);
            if (k + reach < count)
                add(k + reach);
        }
        if (lines > 0)
            result[k] = std::max(sum / static_cast<double>(lines), std::isfinite(raw[k]) ? raw[k] / 6.0 : 0.0);
    }
    return result;
}

}  // namespace

bool FrequencyData::isValid(std::string* reason) const
{
    if (outputs < 1 || inputs < 1 || value.cols() != outputs * inputs
        || value.rows() != static_cast<Index>(frequency.size()))
        return refuse(reason, "its values do not fit its frequencies, inputs and outputs");
    if (frequency.size() < 2)
        return refuse(reason, "it has fewer than two frequencies");
    if (!std::is_sorted(frequency.begin(), frequency.end(), std::less_equal<> {}) || !(frequency.front() >= 0.0)
        || !std::isfinite(frequency.back()))
        return refuse(reason, "its frequencies do not ascend from 0 Hz or above");
    if (!value.allFinite())
        return refuse(reason, "a value is not finite");
    if (!(value.cwiseAbs2().colwise().sum().minCoeff() > 0.0))
        return refuse(reason, "it is zero at all frequencies");
    if (deviation.size() != 0
        && (deviation.rows() != value.rows() || deviation.cols() != value.cols() || !deviation.allFinite()
            || !(deviation.minCoeff() > 0.0)))
        return refuse(reason, "its standard deviations must be as many as its values, and above 0");
    return true;
}

FrequencyData frequencyDataOf(const Frf& frf)
{
    FrequencyData data;
    data.frequency = frf.frequency;
    data.value = Eigen::Map<const Eigen::VectorXcd>(frf.value.data(), static_cast<Index>(frf.value.size()));
    const auto variance = smoothed(frf.totalVariance.empty() ? frf.noiseVariance : frf.totalVariance);
    double least = std::numeric_limits<double>::infinity();
    for (const double v : variance)
        if (isTold(v))
            least = std::min(least, v);
    if (!std::isfinite(least))
        return data;
    data.deviation.resize(data.value.rows(), 1);
    for (Index k = 0; k < data.value.rows(); ++k) {
        const double v = variance[static_cast<std::size_t>(k)];
        data.deviation(k, 0) = std::sqrt(isTold(v) ? v : least);
    }
    return data;
}

Eigen::MatrixXd weightsOf(const FrequencyData& data)
{
    Eigen::MatrixXd weights(data.value.rows(), data.value.cols());
    for (Index e = 0; e < data.value.cols(); ++e) {
        const double rms = data.value.col(e).norm() / std::sqrt(static_cast<double>(data.lines()));
        if (data.deviation.size() == 0)
            weights.col(e).setConstant(1.0 / rms);
        else
            weights.col(e) = (data.deviation.col(e).minCoeff() / rms) * data.deviation.col(e).cwiseInverse();
    }
    return weights;
}

}  // namespace excursion
