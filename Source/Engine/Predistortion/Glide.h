// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>

namespace excursion {

/// A number that follows its target smoothly, through four first-order low-passes in series. After a step of the target
/// it has three continuous derivatives. The second derivative is at most 0.13 of the step over tau^2, and 99 % of the
/// step are done after 10 tau. No allocation, no lock, no exception.
class Glide {
public:
    /// @param tau   s, time constant of each low-pass
    /// @param rate  Hz, of step()
    Glide(double tau, double rate, double value = 0.0) : share_(1.0 - std::exp(-1.0 / (tau * rate))) { jump(value); }

    void jump(double value)
    {
        stages_.fill(target_ = value);
        still_ = true;
    }
    void jump() { jump(target_); }
    void aim(double target)
    {
        still_ = still_ && target == target_;
        target_ = target;
    }

    double step()
    {
        if (still_)
            return target_;
        double from = target_;
        for (auto& stage : stages_)
            from = stage += share_ * (from - stage);
        // What is left is below the rounding of a 32-bit sample by far.
        if (std::abs(from - target_) <= 1e-12 * std::abs(target_) + 1e-15)
            jump(target_);
        return stages_.back();
    }

    double value() const { return stages_.back(); }
    double target() const { return target_; }
    bool still() const { return still_; }

private:
    double share_, target_ = 0.0;
    std::array<double, 4> stages_ {};
    bool still_ = true;
};

}  // namespace excursion
