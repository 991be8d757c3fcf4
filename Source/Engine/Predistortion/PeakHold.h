// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>

namespace excursion {

/// The largest value of the last one to two windows.
class PeakHold {
public:
    /// @param window  steps
    explicit PeakHold(int window) : window_(std::max(window, 1)) {}
    void reset()
    {
        peaks_ = {};
        at_ = 0;
    }
    double step(double next)
    {
        if (++at_ >= window_) {
            at_ = 0;
            peaks_ = {0.0, peaks_[0]};
        }
        peaks_[0] = std::max(peaks_[0], next);
        return value();
    }
    double value() const { return std::max(peaks_[0], peaks_[1]); }

private:
    int window_, at_ = 0;
    std::array<double, 2> peaks_ {};  ///< of this window and of the one before
};

}  // namespace excursion
