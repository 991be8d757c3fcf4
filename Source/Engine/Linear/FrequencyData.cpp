// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/FrequencyData.h"

#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {

using Eigen::Index;

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
    const auto& variance = frf.totalVariance.empty() ? frf.noiseVariance : frf.totalVariance;
    double least = std::numeric_limits<double>::infinity();
    for (const double v : variance)
        if (v > 0.0 && std::isfinite(v))
            least = std::min(least, v);
    if (!std::isfinite(least))
        return data;
    data.deviation.resize(data.value.rows(), 1);
    for (Index k = 0; k < data.value.rows(); ++k) {
        const double v = variance[static_cast<std::size_t>(k)];
        data.deviation(k, 0) = std::sqrt(v > 0.0 && std::isfinite(v) ? v : least);
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
