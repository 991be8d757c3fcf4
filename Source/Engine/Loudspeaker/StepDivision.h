// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/ExponentialStep.h"

#include <array>
#include <vector>

namespace excursion {

/// How many parts a step of one sample needs, by the place where it starts: as few as are stable there
/// (ExponentialStep::isStable). A law is steep at the ends of the excursion or at full speed only, and a cone is there
/// for little of its time. Where a simulation takes several steps a sample each has as many parts, so that its accuracy
/// grows everywhere.
class StepDivision {
public:
    /// The result does not depend on the number of threads.
    StepDivision(const Model&, double sampleRate, unsigned threads);

    /// The power of two of the parts, below StepParts::powers.
    /// @param i  current, A
    /// @param x  displacement, m
    /// @param v  velocity, m/s
    int power(double i, double x, double v) const;

private:
    // Cells between the places where the laws are looked at: quarters of the range in x; the middle and either end in
    // i; up to a quarter, a half and all of the speed, in either direction.
    static constexpr int cellsX = 8, cellsI = 3, speeds = 3, cellsV = 2 * speeds;

    /// The cells of a range that laws share.
    struct Table {
        double displacement, velocity, current;  ///< of the range
        std::array<signed char, cellsX * cellsI * cellsV> power {};
    };
    template <class IsStable>
    static void divide(Table&, const ExponentialStep::LawSlope&, const IsStable&);
    static int cellOfVelocity(double share);
    static int cellOf(int x, int i, int v) { return (x * cellsI + i) * cellsV + v; }

    std::vector<Table> tables_;
};

}  // namespace excursion
