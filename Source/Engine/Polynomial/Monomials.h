// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include <string_view>
#include <vector>

namespace excursion {

/// Exponents of monomials in z = (x_1 .. x_n, u_1 .. u_m), one row each: row a is z_1^a1 z_2^a2 ... [B 4.4 to 4.8].
using Exponents = Eigen::MatrixXi;

/// All monomials of degree lowest .. highest in `variables` variables, graded, then lexicographic [B 4.6]:
/// z1^2, z1 z2, z2^2, z1^3, z1^2 z2, z1 z2^2, z2^3 for 2 variables and degrees 2 .. 3.
/// Throws Error (usage) for degrees below 1 or in the wrong order, or more than a million monomials.
Exponents monomials(int variables, int lowest, int highest);

/// A list of monomials in words, "x1^3,x1*u2,1": factors x1 .. xn and u1 .. um (u alone is u1), each with a power or
/// none, joined by *; 1 is the monomial of degree 0. Throws Error (usage) for what cannot be read, and variables that
/// are not there.
Exponents monomialsNamed(std::string_view list, int states, int inputs);

/// Which monomials a row of E or F may use.
enum class TermMask {
    full,             ///< all
    statesOnly,       ///< those without an input
    noCrossProducts,  ///< powers of one variable
    diagonal          ///< state row i: powers of x_i; output rows: powers of one state
};

std::string_view name(TermMask);  ///< "full", "states-only", "no-cross-products", "diagonal"
std::vector<TermMask> termMasks();

/// True where a row may use a monomial: rows x monomials. @param rows  the n states, then the p outputs
Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> allowed(TermMask, const Exponents&, int states, int outputs);

}  // namespace excursion
