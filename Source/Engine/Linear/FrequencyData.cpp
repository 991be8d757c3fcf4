// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/FrequencyData.h"

#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

namespace excursion {

using Eigen::Index;

namespace {

bool isTold(double variance) { return variance > 0.0 && std::isfinite(variance); }

/// On how many lines a variance must be told together to be known to a sixth, by how much it jumps from line to line:
/// the logarithm of one that so many realizations (or periods) tell scatters by their number alone. The noise itself
/// may be steep, so the jump is that from the line between two others to their middle.
std::size_t linesToShare(const std::vector<double>& variance)
{
    constexpr double enough = 36.0;  // degrees of freedom
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

/// The line through as many neighbours as share, at each place.
std::vector<double> trendOf(const std::vector<double>& values, std::size_t share)
{
    const std::size_t count = values.size(), width = std::min(share, count);
    std::vector<double> trend(count);
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t first = std::min(k > width / 2 ? k - width / 2 : 0, count - width);
        const double n = static_cast<double>(width), middle = static_cast<double>(first) + 0.5 * (n - 1.0);
        double mean = 0.0, slope = 0.0;
        for (std::size_t j = first; j < first + width; ++j) {
            mean += values[j] / n;
            slope += values[j] * (static_cast<double>(j) - middle);
        }
        trend[k] = mean + (width > 1 ? slope * 12.0 / (n * (n * n - 1.0)) : 0.0) * (static_cast<double>(k) - middle);
    }
    return trend;
}

/// The scatter of a few realizations tells the noise of a line only roughly, and a line that it makes too quiet by
/// chance would weigh too much. So neighbouring lines share theirs, in logarithms, as noise may be steep, and as it
/// goes with the response: that of an impedance peaks where the impedance does. A line that sticks out (hum) keeps its
/// own. Where the noise is known well, nothing changes.
std::vector<double> smoothed(const std::vector<double>& raw, const std::vector<std::complex<double>>& response)
{
    const std::size_t share = linesToShare(raw);
    if (share < 2)
        return raw;
    constexpr double mostPower = 4.0;  // of the response that a variance goes with
    constexpr double mostOff = 10.0;   // times what the lines share: more is no scatter
    std::vector<std::size_t> lines;
    std::vector<double> variance, gain;  // logarithms
    for (std::size_t k = 0; k < raw.size(); ++k)
        if (isTold(raw[k]) && std::abs(response[k]) > 0.0) {
            lines.push_back(k);
            variance.push_back(std::log(raw[k]));
            gain.push_back(std::log(std::abs(response[k])));
        }
    const auto shared = trendOf(variance, share), level = trendOf(gain, share);
    double along = 0.0, power = 0.0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        along += (variance[i] - shared[i]) * (gain[i] - level[i]);
        power += std::pow(gain[i] - level[i], 2);
    }
    const double exponent = power > 0.0 ? std::clamp(along / power, 0.0, mostPower) : 0.0;
    auto result = raw;
    double mean = 0.0;  // of the variances over what a mean of logarithms makes of them
    for (std::size_t i = 0; i < lines.size(); ++i) {
        double& v = result[lines[i]];
        v = std::exp(shared[i] + exponent * (gain[i] - level[i]));
        mean += std::min(raw[lines[i]] / v, mostOff) / static_cast<double>(lines.size());
    }
    for (const auto k : lines)
        result[k] = std::max(mean * result[k], raw[k] / 6.0);
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
    const auto variance = smoothed(frf.totalVariance.empty() ? frf.noiseVariance : frf.totalVariance, frf.value);
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
