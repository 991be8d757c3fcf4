// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

namespace excursion {

/// The weight of something that is switched in and out while a signal runs: from 0 to 1 and back along s^3 (10 - 15 s +
/// 6 s^2), whose first two derivatives are zero at both ends. Before it fades in, it may wait until its filters have
/// filled.
class Fade {
public:
    /// @param length, wait  samples
    explicit Fade(int length, int wait = 0) : length_(std::max(length, 1)), wait_(std::max(wait, 0)) {}

    void turn(bool on)
    {
        if (on && !on_ && place_ == 0)
            waiting_ = wait_;
        on_ = on;
    }
    void jump()
    {
        place_ = on_ ? length_ : 0;
        waiting_ = 0;
    }
    bool on() const { return on_; }
    bool runs() const { return on_ || place_ > 0; }  ///< the fading signal must be computed

    double step()
    {
        if (on_ && waiting_ > 0)
            --waiting_;
        else
            place_ = on_ ? std::min(place_ + 1, length_) : std::max(place_ - 1, 0);
        return weight();
    }
    double weight() const
    {
        const double s = static_cast<double>(place_) / length_;
        return place_ == length_ ? 1.0 : s * s * s * (10.0 + s * (6.0 * s - 15.0));
    }

private:
    int length_, wait_, waiting_ = 0, place_ = 0;
    bool on_ = false;
};

}  // namespace excursion
