// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Predistortion/LinearMemory.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace excursion {

/// Steps the memory m of one effect along a given motion, dm/dt = r(m; i, x, v) with r from the effect, if LinearMemory
/// cannot. The method depends on r:
///   - dm/dt = A m + b (i, x, v): exact for cubic motions;
///   - dm/dt = -diag(p) m + N(i, x, v, m), where the change of m in one step changes N little: exact in -diag(p) m,
///     with N a cubic through its values at the latest four samples. For the newest of them m is predicted with an N
///     that is the parabola through the three before. So N is evaluated once per step;
///   - anything else: the classical Runge-Kutta method.
class Memory {
public:
    /// @param coefficients  of the effect, prepared
    Memory(const Effect&, const OperatingRange&, std::vector<double> coefficients, double sampleRate);

    std::size_t size() const { return size_; }
    void reset();

    /// One step of 1/sampleRate.
    void step(const MotionCubic&);
    /// Undoes the latest step.
    void stepBack();

    const double* value() const { return value_.data(); }
    void set(const double* value);  ///< at rest, with this value
    /// Goes by a share of the way to another memory of the same effect.
    void approach(const Memory& other, double share);
    /// For what changes little within a period: goes on for a time by the rate that a motion gives, and no more than
    /// that.
    void drift(double i, double x, double v, double seconds);
    double dropPerCurrent();   ///< ohm: what the effect adds to the voltage at rest for 1 A more
    const double* findRate();  ///< dm/dt at the end of the latest step, 1/s
    /// d m(1) / d i(1) for a current that is a Cubic::past; 0 if the memory is not linear.
    const double* byCurrent() const { return byCurrent_.data(); }

    /// Corrects the current at the end of the step by this difference (A).
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
    std::vector<double> decay_;                  ///< exp(A T): by columns, or only its diagonal if driven
    std::array<std::vector<double>, 12> drive_;  ///< G: per coefficient of i, x and v
    std::vector<double> own_;                    ///< -p
    std::array<std::vector<double>, 4> weight_;  ///< of N at the latest four samples, the newest first
    std::array<std::vector<double>, 4> N_;       ///< a ring
    std::size_t newest_ = 0;
    std::array<std::vector<double>, 5> stages_;  ///< of the Runge-Kutta method
};

}  // namespace excursion
