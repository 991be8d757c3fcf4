// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/Loopback.h"

#include "Engine/Import/PeriodDelays.h"
#include "Engine/Numerics/Median.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion {

InterfaceResponse interfaceResponse(const PlanPeriods& plan, std::span<const double> loopback,
                                    const std::vector<std::size_t>& used, double sampleRate)
{
    const auto delays = periodDelays(plan, loopback, used, false, 1);
    const auto& H = delays.response;
    // The gain that most lines share: the median is not moved by what a band does at its edges.
    std::vector<double> sizes;
    std::complex<double> direction = 0.0;
    for (const auto& value : H) {
        sizes.push_back(std::abs(value));
        direction += value;
    }
    const double gain = medianOf(std::move(sizes)) * (direction.real() < 0 ? -1.0 : 1.0);

    const double halfWidth = std::exp2(1.0 / 24.0);
    InterfaceResponse result;
    std::vector<double> frequency;
    std::vector<std::complex<double>> value;
    double departure = 0.0, uncertainty = 0.0;
    for (std::size_t k = 0, first = 0, end = 0; k < H.size(); ++k) {
        const double line = plan.lines[k];
        while (plan.lines[first] < line / halfWidth)
            ++first;
        while (end < H.size() && plan.lines[end] <= line * halfWidth)
            ++end;
        std::complex<double> mean = 0.0;
        double variance = 0.0;
        for (auto j = first; j < end; ++j) {
            mean += H[j];
            variance += delays.variance[j];
        }
        const auto count = static_cast<double>(end - first);
        frequency.push_back(line * sampleRate / static_cast<double>(plan.length));
        value.push_back(mean / count / gain);
        variance /= count * count * gain * gain;
        departure += std::norm(value.back() - 1.0) / static_cast<double>(H.size());
        uncertainty += variance / static_cast<double>(H.size());
        result.mostDb = std::max(result.mostDb, std::abs(20.0 * std::log10(std::abs(value.back()))));
        result.mostDegrees = std::max(result.mostDegrees, std::abs(std::arg(value.back())) * 180.0 / std::numbers::pi);
    }
    result.errorDb = 20.0 / std::numbers::ln10 * std::sqrt(uncertainty / 2);
    result.flat = departure <= std::max(4.0 * uncertainty, 1e-8);
    if (!result.flat)
        result.curve = ResponseCurve(std::move(frequency), value);
    return result;
}

}  // namespace excursion
