// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/Glide.h"

#include <cmath>

namespace excursion {

/// What the decisions of Protection share. It decides once per tick.
namespace ticks {

inline constexpr int samples = 16;  ///< samples per tick

/// Number of ticks in a time, s; at least 1.
inline int in(double seconds, double sampleRate) { return static_cast<int>(std::ceil(seconds * sampleRate / samples)); }

/// The share of a step that a first-order low-pass covers in one tick.
/// @param tau  s
inline double share(double tau, double sampleRate) { return 1.0 - std::exp(-samples / (tau * sampleRate)); }

}  // namespace ticks

/// A factor of a signal, 0 to 1, that falls at once when needed, and comes back slowly. While its limit is changing, it
/// also falls slowly, so that moving a limit does not distort the signal.
class Factor {
public:
    /// @param release  s, time constant of its return
    Factor(double release, double sampleRate)
        : share_(ticks::share(release, sampleRate)), ease_(easeTime, sampleRate / ticks::samples, 1.0)
    {
    }

    void reset() { ease_.jump(1.0); }

    /// @param need  the largest allowed factor
    double step(double need, bool slowly)
    {
        double next = need;
        if (const double now = value(); need >= now) {
            next = now + share_ * (need - now);
            if (next > 1.0 - 1e-6)  // it also arrives
                next = 1.0;
        }
        if (slowly) {
            ease_.aim(next);
            ease_.step();
        } else {
            ease_.jump(next);
        }
        return value();
    }
    double value() const { return ease_.value(); }

private:
    static constexpr double easeTime = 0.0025;  ///< s, see Glide
    double share_;
    Glide ease_;
};

}  // namespace excursion
