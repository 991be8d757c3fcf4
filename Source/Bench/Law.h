// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Bench/Curve.h"

#include <optional>

namespace excursion::bench {

/// A curve prepared for the time loop: base * value(q) with the normalization computed once. Without a curve it is the
/// constant base.
class Law {
public:
    Law() = default;
    Law(const std::optional<Curve>& curve, double base) : base_(base)
    {
        if (!curve)
            return;
        present_ = true;
        curve_ = *curve;
        base_ /= curve->at(-curve->centre / curve->width).value;
        inverseWidth_ = 1.0 / curve->width;
    }

    bool present() const { return present_; }

    Curve::Point operator()(double q) const  ///< value, and slope with respect to q
    {
        if (!present_)
            return {base_, 0.0};
        const auto point = curve_.at((q - curve_.centre) * inverseWidth_);
        return {base_ * point.value, base_ * point.slope * inverseWidth_};
    }

private:
    Curve curve_;
    double base_ = 1.0, inverseWidth_ = 1.0;
    bool present_ = false;
};

}  // namespace excursion::bench
