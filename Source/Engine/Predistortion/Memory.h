// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Predistortion/LinearMemory.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace excursion {

/// Carries the memory m of one effect along a given motion, dm/dt = r(m; i, x, v) with r as the effect states it, where
/// LinearMemory does not do it. How it is stepped is found out by asking r:
///   - dm/dt = A m + b (i, x, v): exact for cubic motions;
///   - dm/dt = -diag(p) m + N(i, x, v, m), in which what a step changes of m changes N little: exact in -diag(p) m,
///   with
///     N a cubic through its values at the latest four samples. For the newest of them m is foretold with an N that
///     is the parabola through the three before. So N is asked once a step;
///   - anything else: the classical Runge-Kutta method.
class Memory {
public:
    /// @param coefficients  of the effect, prepared
    Memory(const Effect&, const OperatingRange&, std::vector<double> coefficients, double sampleRate);

    std::size_t size() const { return size_; }
    void reset();

    /// One step of 1/sampleRate.
    void step(const MotionCubic&);
    /// Takes the latest step back.
    void stepBack();

    const double* value() const { return value_.data(); }
    const double* findRate();  ///< dm/dt at the end of the latest step, 1/s
    /// d m(1) / d i(1) of a current that is a Cubic::past; 0 where the memory is not linear.
    const double* byCurrent() const { return byCurrent_.data(); }

    /// The end of the current on the step was different by that much (A).
    void correct(double current);

private:
    enum class Kind { linear, driven, any };

    void rates(double i, double x, double v, const double* m, double* out) const;
    bool findDriven(double sampleRate);
    void prepareLinear(const LinearRates&, double sampleRate);
    void stepLinear(const MotionCubic&);
    void stepDriven();
    void stepAny(const MotionCubic&);

    const Effect* effect_;
    OperatingRange operatingRange_;
    std::vector<double> coefficients_;
    double period_;
    std::size_t size_;
    Kind kind_ = Kind::any;
    std::vector<double> value_, rate_, byCurrent_, next_, before_;  ///< before_: the value before the latest step
    std::array<double, 3> end_ {};                                  ///< i, x, v at the end of the latest step
    std::vector<double> decay_;                  ///< exp(A T): by columns, or its diagonal when driven
    std::array<std::vector<double>, 12> drive_;  ///< G: by the coefficients of i, x and v
    std::vector<double> own_;                    ///< -p
    std::array<std::vector<double>, 4> weight_;  ///< of N at the latest four samples, the newest first
    std::array<std::vector<double>, 4> N_;       ///< a ring
    std::size_t newest_ = 0;
    std::array<std::vector<double>, 5> stages_;  ///< of the Runge-Kutta method
};

}  // namespace excursion
