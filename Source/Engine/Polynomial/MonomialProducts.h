// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/Monomials.h"

namespace excursion {

/// Monomials in z = (x, u) compiled to products that they share, and their slopes by the states: a list of numbers, the
/// *nodes*,
///     1, z_1 .. z_{n+m}, then one product of two earlier nodes each,
/// among which every monomial and every d(monomial)/d(state), up to its whole factor, is found.
class MonomialProducts {
public:
    struct Product {
        Eigen::Index left, right;  ///< nodes
    };
    struct Slope {  ///< d(monomial `term`)/d(x_state) = factor * node
        Eigen::Index term, state, node;
        double factor;
    };

    /// @param exponents  K x (n + m); may have no rows @param variables  n + m @param states  n, the first of the
    /// variables
    MonomialProducts(const Exponents& exponents, Eigen::Index variables, Eigen::Index states);

    Eigen::Index nodes() const { return static_cast<Eigen::Index>(nodes_.size()); }
    Eigen::Index termNode(Eigen::Index term) const { return termNode_[static_cast<std::size_t>(term)]; }
    const std::vector<Product>& products() const { return products_; }  ///< nodes 1 + n + m and on, in order
    const std::vector<Slope>& slopes() const { return slopes_; }

    /// All nodes at one point. @param values  nodes() numbers, of which 1 .. n + m hold z
    void evaluate(double* values) const
    {
        values[0] = 1.0;
        double* out = values + 1 + variables_;
        for (const auto& product : products_)
            *out++ = values[product.left] * values[product.right];
    }

private:
    Eigen::Index node(const Eigen::RowVectorXi& exponents);

    Eigen::Index variables_;
    std::vector<Eigen::RowVectorXi> nodes_;  // exponents
    std::vector<Product> products_;
    std::vector<Eigen::Index> termNode_;
    std::vector<Slope> slopes_;
};

}  // namespace excursion
