// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <cstddef>
#include <span>

namespace excursion {

/// One period of a motion, read at any place: whole numbers are its values, what lies between is on a straight line.
struct MotionView {
    std::span<const double> i, x, v;  ///< A, m, m/s

    template <class T>
    Motion<T> at(double place) const
    {
        const auto whole = static_cast<std::size_t>(place);
        const double share = place - static_cast<double>(whole);
        const std::size_t here = whole % i.size(), next = (here + 1) % i.size();
        const auto between = [&](std::span<const double> q) { return T(q[here] + share * (q[next] - q[here])); };
        return {between(i), between(x), between(v)};
    }
};

/// How a law's memory goes along a motion.
struct Pace {
    int steps = 1;  ///< a sample, in which the memory can be followed: its fastest rate times one stays below one
    bool quarterForgets = true;  ///< nothing of what was is left of its slowest part after a quarter of the period
    bool steady = true;          ///< each state forgets at a rate of its own that nothing changes, dm/dt = a - r m
    double slowest = 0.0;        ///< 1/s, of these rates, or of their means
    double fastest = 0.0;        ///< 1/s, at any place
};

/// @param perSample  values of the motion a sample
Pace paceOf(const Component& law, const MotionView&, std::size_t perSample, double sampleRate);

/// The same along some motion through a law's whole operating range.
Pace paceOf(const Component& law, double sampleRate);

}  // namespace excursion
