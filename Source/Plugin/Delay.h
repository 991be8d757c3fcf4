// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace excursion::plugin {

/// The signal as it is, later: what is played where no engine can run. A sample that is not a finite number is silence.
/// Only its construction allocates.
class Delay {
public:
    explicit Delay(int samples) : ring_(static_cast<std::size_t>(samples)) {}

    void reset() { std::fill(ring_.begin(), ring_.end(), 0.0); }

    void process(double* samples, std::size_t n)
    {
        for (std::size_t k = 0; k < n; ++k) {
            if (!std::isfinite(samples[k]))
                samples[k] = 0.0;
            if (ring_.empty())
                continue;
            std::swap(samples[k], ring_[at_]);
            at_ = at_ + 1 == ring_.size() ? 0 : at_ + 1;
        }
    }

private:
    std::vector<double> ring_;
    std::size_t at_ = 0;
};

}  // namespace excursion::plugin
