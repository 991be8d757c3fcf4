// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/Identify.h"
#include "Engine/Signal/Fft.h"

namespace excursion::test {

/// The mean of Y/U over records of one length, on the lines that all inputs excite.
inline FrequencyData meanResponse(const std::vector<Eigen::VectorXd>& u, const std::vector<Eigen::VectorXd>& y,
                                  double rate)
{
    const auto N = u[0].size();
    const auto spectrum = [N](const Eigen::VectorXd& x) {
        return fft(std::span<const double>(x.data(), static_cast<std::size_t>(N)));
    };
    std::vector<std::complex<double>> mean(static_cast<std::size_t>(N / 2), 0.0);
    std::vector<bool> excited(mean.size(), true);
    for (std::size_t r = 0; r < u.size(); ++r) {
        const auto U = spectrum(u[r]), Y = spectrum(y[r]);
        double largest = 0.0;
        for (const auto& value : U)
            largest = std::max(largest, std::abs(value));
        for (std::size_t k = 1; k < mean.size(); ++k) {
            excited[k] = excited[k] && std::abs(U[k]) > 1e-3 * largest;
            mean[k] += Y[k] / U[k] / static_cast<double>(u.size());
        }
    }
    Frf frf;
    for (std::size_t k = 1; k < mean.size(); ++k)
        if (excited[k]) {
            frf.frequency.push_back(static_cast<double>(k) * rate / static_cast<double>(N));
            frf.value.push_back(mean[k]);
        }
    return frequencyDataOf(frf);
}

inline StateSpace linearStart(const FrequencyData& data, int order, double rate)
{
    IdentifyOptions options;
    options.order = order;
    options.sampleRate = rate;
    return identify(data, options).model;
}

}  // namespace excursion::test
