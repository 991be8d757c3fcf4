// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/MonomialProducts.h"
#include "Engine/Polynomial/Pnlss/Pnlss.h"

#include <vector>

namespace excursion {

/// The Volterra kernels of a PNLSS model, exactly, around the state x0 in which it rests without input (0, unless it
/// has constant terms):
///     y(t) = y0 + sum_n sum_{t1 .. tn} h_n(t1 .. tn) u(t - t1) .. u(t - tn),
///         H_n(f1 .. fn) = sum h_n exp(-j (w1 t1 + .. + wn tn))
/// symmetrized: h_n and H_n do not change when their arguments change places (with their inputs, where there are
/// several).
///
/// By growing exponentials (harmonic probing; Rugh 1981, chapter 3): with u = sum_i e_i z_i^t, z_i = exp(j w_i), the
/// part of the state that belongs to e_1 e_2 .. e_n is x_S (z_1 z_2 .. z_n)^t, S = {1 .. n}, and
///     (z_S I - A - E dp/dx(x0)) x_S = B u_S + E p_S(parts of smaller sets),   y_S = C x_S + D u_S + F p_S = n! H_n
/// for each subset from the smallest up. The polynomials are multiplied in numbers e_i with e_i^2 = 0, one component a
/// subset, so nothing is derived by hand and any order costs the same lines. The kernels in time come from the same
/// numbers with impulses in place of exponentials, by the recursion itself.
class Volterra {
public:
    /// Throws Error (usage) for a model that is not valid, (data) where it is not stable around its rest: its kernels
    /// do not die; (numerical) when no rest is found.
    explicit Volterra(const Pnlss&);

    const Eigen::VectorXd& rest() const { return rest_; }      ///< x0
    const Eigen::VectorXd& offset() const { return offset_; }  ///< y0, p

    /// H_n at n frequencies in Hz of either sign, of all outputs. @param inputs  of each frequency; empty: the first
    /// Throws Error (usage) for orders other than 1 .. 6, or inputs that are not there.
    Eigen::VectorXcd response(const std::vector<double>& frequency, const std::vector<Eigen::Index>& inputs = {}) const;

    /// h_n(t - s1, .., t - sn) for t = 0 .. length-1, length x p: what impulses at s1 .. sn >= 0 bring about together,
    /// over n!.
    Eigen::MatrixXd kernel(const std::vector<Eigen::Index>& impulses, Eigen::Index length,
                           const std::vector<Eigen::Index>& inputs = {}) const;

    /// The output's parts of orders 1 .. highest, N x p each, to an input, N x m, from rest: y = y0 + their sum, to
    /// terms of order highest
    /// + 1.
    std::vector<Eigen::MatrixXd> parts(const Eigen::MatrixXd& input, int highest) const;

private:
    template <class Algebra, class Number>
    void multiply(const Algebra&, Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic>& nodes,
                  Eigen::Index component) const;
    std::vector<Eigen::Index> inputsOf(std::size_t order, const std::vector<Eigen::Index>& given) const;

    Pnlss model_;
    MonomialProducts products_;
    Eigen::VectorXd rest_, offset_;
    Eigen::MatrixXd slope_;               // A + E dp/dx(x0)
    Eigen::MatrixXd toState_, toOutput_;  // [A B E], [C D F] from the nodes
};

}  // namespace excursion
