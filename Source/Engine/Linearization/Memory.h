// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Driver/Model.h"
#include "Engine/Linearization/Cubic.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace excursion {

/// Current, position and velocity on one step.
struct MotionCubic {
    Cubic i, x, v;
};

/// Carries the memory m of one effect along a given motion, dm/dt = r(m; i, x, v) with r as the effect states it. Where r turns
/// out to be linear, dm/dt = A m + b_i i + b_x x + b_v v (ladders, relaxations), the step is exact for cubic motions,
///     m(1) = exp(A T) m(0) + sum_q sum_k G_qk c_qk,
/// however fast the fastest cell; any other memory is stepped by the classical Runge-Kutta method.
class Memory {
public:
    /// @param coefficients  of the effect, prepared
    Memory(const Effect&, const Extent&, std::vector<double> coefficients, double sampleRate);

    std::size_t size() const { return size_; }
    void reset();

    /// One step of 1/sampleRate.
    void step(const MotionCubic&);
    /// Takes the latest step back.
    void stepBack() { std::copy(before_.begin(), before_.end(), value_.begin()); }

    const double* value() const { return value_.data(); }
    const double* findRate();   ///< dm/dt at the end of the latest step, 1/s
    /// d m(1) / d i(1) of a current that is a Cubic::past; 0 where the memory is not linear.
    const double* byCurrent() const { return byCurrent_.data(); }

    /// The end of the current on the step was different by that much (A).
    void correct(double current);

private:
    void rates(double i, double x, double v, const double* m, double* out) const;
    bool probe(double sampleRate);

    const Effect* effect_;
    Extent extent_;
    std::vector<double> coefficients_;
    double period_;
    std::size_t size_;
    bool linear_ = false, diagonal_ = false;
    std::vector<double> value_, rate_, byCurrent_, next_, before_;   ///< before_: the value before the latest step
    std::array<double, 3> end_ {};        ///< i, x, v at the end of the latest step
    std::vector<double> decay_;           ///< exp(A T): its diagonal, or all of it by columns
    struct Drive {
        std::array<std::vector<double>, 4> weight;   ///< G_k
        bool present = false;
    };
    std::array<Drive, 3> drives_;   ///< by i, x and v
    std::array<std::vector<double>, 5> stages_;   ///< of the Runge-Kutta method
};

} // namespace excursion
