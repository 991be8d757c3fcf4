// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/MonomialProducts.h"

namespace excursion {

using Eigen::Index;

MonomialProducts::MonomialProducts(const Exponents& exponents, Index variables, Index states) : variables_(variables)
{
    nodes_.push_back(Eigen::RowVectorXi::Zero(variables));
    for (Index v = 0; v < variables; ++v)
        nodes_.push_back(Eigen::RowVectorXi::Unit(variables, v));
    for (Index k = 0; k < exponents.rows(); ++k)
        termNode_.push_back(node(exponents.row(k)));
    for (Index k = 0; k < exponents.rows(); ++k)
        for (Index j = 0; j < states; ++j)
            if (exponents(k, j) > 0) {
                Eigen::RowVectorXi reduced = exponents.row(k);
                reduced[j] -= 1;
                slopes_.push_back({k, j, node(reduced), static_cast<double>(exponents(k, j))});
            }
}

Index MonomialProducts::node(const Eigen::RowVectorXi& exponents)
{
    for (std::size_t k = 0; k < nodes_.size(); ++k)
        if (nodes_[k] == exponents)
            return static_cast<Index>(k);
    // z_v times the rest, which may have to be made first
    Index v = 0;
    while (exponents[v] == 0)
        ++v;
    Eigen::RowVectorXi rest = exponents;
    rest[v] -= 1;
    const Index right = node(rest);
    nodes_.push_back(exponents);
    products_.push_back({1 + v, right});
    return static_cast<Index>(nodes_.size()) - 1;
}

}  // namespace excursion
