// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <array>
#include <vector>

namespace excursion {

/// How many parts the step of a simulation has, by the place where it starts: as few as are stable there
/// (ExponentialStep::isStable). A law is steep at the ends of the excursion or at full speed only, and a cone is there
/// for little of its time.
class StepDivision {
public:
    static constexpr int powers = 7;  ///< 1, 2, 4 .. 64 parts

    /// @param step  s
    StepDivision(const Model&, double step);

    double step() const { return step_; }  ///< s

    /// The power of two of the parts.
    /// @param i  current, A
    /// @param x  displacement, m
    /// @param v  velocity, m/s
    int power(double i, double x, double v) const;

private:
    // Cells between the places where the laws are looked at: a quarter of the range in x; the middle and either end in
    // i; thrice half the speed in either direction.
    static constexpr int cellsX = 8, cellsI = 3, speeds = 3, cellsV = 2 * speeds;

    /// The cells of a range that laws share.
    struct Table {
        double displacement, velocity, current;  ///< of the range
        std::array<signed char, cellsX * cellsI * cellsV> power {};
    };
    static int cellOfVelocity(double share);
    static int cellOf(int x, int i, int v) { return (x * cellsI + i) * cellsV + v; }

    double step_;
    std::vector<Table> tables_;
};

}  // namespace excursion
