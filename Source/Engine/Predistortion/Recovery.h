// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

namespace excursion {

/// The weight of a computation that had to be reset. After the fault it is 0 until the old signal has left every
/// filter, then it rises smoothly to 1.
class Recovery {
public:
    /// @param hold, rise  samples
    Recovery(int hold, int rise) : hold_(hold), rise_(std::max(rise, 1)) {}

    void reset()
    {
        wait_ = place_ = 0;
        weight_ = 1.0;
    }
    void fault()
    {
        wait_ = hold_;
        place_ = rise_;
        weight_ = 0.0;
    }
    bool running() const { return weight_ >= 1.0; }

    /// The weight at the next sample.
    double step()
    {
        if (wait_ > 0) {
            --wait_;
        } else if (place_ > 0) {
            --place_;
            const double left = static_cast<double>(place_) / rise_;
            weight_ = 1.0 - left * left * (3.0 - 2.0 * left);
        }
        return weight_;
    }

private:
    int hold_, rise_, wait_ = 0, place_ = 0;
    double weight_ = 1.0;
};

}  // namespace excursion
