// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plots/Plot.h"
#include "Plugin/Juce.h"

#include <functional>
#include <vector>

namespace excursion::plugin {

/// What an axis spans.
struct AxisRange {
    double least = 0.0, most = 1.0;
    bool logarithmic = false;

    double share(double value) const;  ///< 0 at least, 1 at most
    double value(double share) const;
    /// The part between two shares; no smaller than a double can tell apart.
    AxisRange part(double from, double to) const;
    bool operator==(const AxisRange&) const = default;
};

/// As the plot says, otherwise what its finite data needs.
AxisRange rangeOf(const Plot&, bool across);

struct AxisLabel {
    double value;
    juce::String text;
};

/// With as many decimals as tell neighbours apart that are `step` from each other; powers of ten where those would be
/// many.
juce::String numberText(double value, double step);

/// The labels of an axis of `length` px: round numbers (1, 2, 5 times powers of ten; of a logarithmic axis that spans
/// less than three of those, equal steps), as many as stand without touching, and never less than three.
/// @param extent  px that a text takes along the axis
/// @param gap     px between two
std::vector<AxisLabel> labelsOf(const AxisRange&, float length, const std::function<float(const juce::String&)>& extent,
                                float gap);

}  // namespace excursion::plugin
