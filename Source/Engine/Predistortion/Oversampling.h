// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/HalfBand.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// Up to 1, 2 or 4 times the rate and back, by linear-phase half-band filters: flat to 0.45 of the lower rate, -110 dB
/// from 0.55 of it on. The delay of up and down together is an integer number of samples of the lower rate.
class Oversampling {
public:
    static constexpr std::size_t longestBlock = 64;  ///< samples of the lower rate in one call

    /// @param factor  1, 2 or 4; else Error (usage)
    explicit Oversampling(int factor);

    int factor() const { return factor_; }
    int latency() const { return latency_; }  ///< of up and down together, samples of the lower rate
    void reset();

    void up(const double* in, std::size_t n, double* out);    ///< n <= longestBlock in, n * factor out
    void down(const double* in, std::size_t n, double* out);  ///< n * factor in, n out

private:
    int factor_, latency_ = 0;
    std::optional<Doubler> firstUp_, secondUp_;
    std::optional<Halver> firstDown_, secondDown_;
    double late_ = 0.0;  ///< one sample of the double rate, which makes the delay of the second stage an integer
    std::vector<double> middle_;
};

}  // namespace excursion
