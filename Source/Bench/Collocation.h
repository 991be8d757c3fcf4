// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Bench/Relaxation.h"

#include <array>
#include <complex>
#include <vector>

namespace excursion::bench {

using Triple = std::array<double, 3>;  ///< a quantity at the three points of a step
using Square = std::array<Triple, 3>;

/// Three-point Radau IIA collocation (order 5, stiffly accurate, L-stable): within a step of length 1, a signal is the
/// parabola through its values at c = (4 - sqrt 6)/10, (4 + sqrt 6)/10 and 1.
struct Radau {
    static const Triple& points();  ///< c
    static const Square& once();    ///< A: integral of the parabola through unit l, from 0 to c_j
    static const Square& twice();   ///< A*A: its double integral
    /// Values at this step's points extrapolated from the three of the step before and the three of
    /// the one before that: a polynomial of degree 5; weights [point][0..2 older, 3..5 newer].
    static const std::array<std::array<double, 6>, 3>& extrapolation();
};

/// integral_0^c exp(-q (c - s)) s^p ds for p = 0, 1, 2 (q may be complex, with Re q >= 0).
std::array<std::complex<double>, 3> decayedPowers(std::complex<double> q, double c);

/// out[j][l]: the value at c_j of exp(-q t) convolved with the parabola through unit l.
std::array<std::array<std::complex<double>, 3>, 3> decayedParabola(std::complex<double> q);

/// x of M x = r by cofactors.
Triple solve(const Square& M, const Triple& r);

/// Relaxations stepped exactly for an input that is a parabola within the step, no matter how stiff the cell is.
class RelaxationBank {
public:
    RelaxationBank() = default;
    RelaxationBank(const Relaxations&, double step);  ///< step in s

    /// The output at the three points is history() + gain() * input.
    Triple history() const;
    const Square& gain() const { return gain_; }
    void advance(const Triple& input);

private:
    std::vector<double> state_;
    std::array<std::vector<double>, 3> look_;  // weight exp(-rate c_j h)
    std::vector<double> decay_;
    std::array<std::vector<double>, 3> take_;  // contribution of the input at point l at the end
    Square gain_ {};
};

}  // namespace excursion::bench
