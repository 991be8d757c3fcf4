// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Numerics/LuFactors.h"
#include "Engine/Numerics/StateUnits.h"

#include <algorithm>
#include <complex>
#include <vector>

namespace excursion {

/// (s I - A)^-1 at one s after another, for the linear part of a driver. The first three states, current and motion,
/// drive all others. A memory drives these three, and only memories of its own effect. So A is an arrow matrix:
/// eliminating the memories, one small group at a time, leaves three equations,
///     S = s I - A_cc - sum_g A_cg R_g A_gc,   R_g = (s I - A_gg)^-1,
/// and each s costs as many operations as A has entries. The groups are found from A: uncoupled states stay separate,
/// and rounding does not join them.
class ArrowResolvent {
public:
    explicit ArrowResolvent(const Eigen::MatrixXd& A) : units_(stateUnits(A))
    {
        const Eigen::MatrixXd balanced = inUnits(A, units_);
        order_.resize(static_cast<std::size_t>(A.rows()));
        for (std::size_t k = 0; k < order_.size(); ++k)
            order_[k] = static_cast<Eigen::Index>(k);
        const auto groups = groupsOf(balanced);
        std::stable_sort(order_.begin() + core, order_.end(),
                         [&](Eigen::Index a, Eigen::Index b) { return before(groups, a, b); });
        A_ = balanced(order_, order_).cast<std::complex<double>>();
        for (Eigen::Index k = core; k < A_.rows(); k += size(groups, k))
            if (size(groups, k) == 1)
                ++singles_;
            else
                groups_.push_back({k, size(groups, k)});
        poles_ = A_.diagonal().segment(core, singles_);
        into_ = A_.bottomLeftCorner(A_.rows() - core, core);
        from_ = A_.topRightCorner(core, A_.rows() - core);
        own_.resize(singles_);
        solved_.resize(groups_.size());
        forth_.resize(into_.rows(), core);
        back_.resize(core, into_.rows());
    }

    void moveTo(std::complex<double> s)
    {
        for (Eigen::Index k = 0; k < singles_; ++k)
            own_[k] = reciprocal(s - poles_[k]);
        forth_.topRows(singles_) = own_.asDiagonal() * into_.topRows(singles_);
        back_.leftCols(singles_) = from_.leftCols(singles_) * own_.asDiagonal();
        for (std::size_t g = 0; g < groups_.size(); ++g) {
            const auto& [first, n] = groups_[g];
            system_ = -A_.block(first, first, n, n);
            system_.diagonal().array() += s;
            invert(system_, solved_[g]);
            forth_.middleRows(first - core, n).noalias() = solved_[g] * into_.middleRows(first - core, n);
            back_.middleCols(first - core, n).noalias() = from_.middleCols(first - core, n) * solved_[g];
        }
        Eigen::Matrix3cd S = -A_.topLeftCorner<core, core>();
        S.noalias() -= from_ * forth_;
        S.diagonal().array() += s;
        core_ = S.inverse();
    }

    /// B, and a row c, in the form that column() and row() need at every s.
    Eigen::VectorXcd turnedRight(const Eigen::VectorXcd& B) const { return B.cwiseQuotient(units_)(order_); }
    Eigen::VectorXcd turnedLeft(const Eigen::RowVectorXd& c) const
    {
        return c.transpose().cwiseProduct(units_)(order_).cast<std::complex<double>>();
    }

    /// (s I - A)^-1 B.
    Eigen::VectorXcd column(const Eigen::VectorXcd& b) const
    {
        Eigen::VectorXcd y = b;
        auto memories = y.tail(y.size() - core);
        const Eigen::Vector3cd motion = core_ * (b.head<core>() + back_ * b.tail(b.size() - core));
        solveOwn(memories, false);
        y.head<core>() = motion;
        memories.noalias() += forth_ * motion;
        return inOrder(y).cwiseProduct(units_);
    }

    /// The same of many columns.
    Eigen::MatrixXcd columns(const Eigen::MatrixXcd& b) const
    {
        Eigen::MatrixXcd y(b.rows(), b.cols()), z(b.rows(), b.cols());
        y.topRows(core).noalias() = back_.lazyProduct(b.bottomRows(b.rows() - core));
        y.topRows(core) = (core_ * (b.topRows(core) + y.topRows(core))).eval();
        auto memories = y.bottomRows(b.rows() - core);
        memories.topRows(singles_) = own_.asDiagonal() * b.middleRows(core, singles_);
        for (std::size_t g = 0; g < groups_.size(); ++g)
            y.middleRows(groups_[g].first, groups_[g].size).noalias() = solved_[g].lazyProduct(
                b.middleRows(groups_[g].first, groups_[g].size));
        memories.noalias() += forth_.lazyProduct(y.topRows(core));
        for (std::size_t k = 0; k < order_.size(); ++k)
            z.row(order_[k]) = y.row(static_cast<Eigen::Index>(k)) * units_[order_[k]];
        return z;
    }

    /// c (s I - A)^-1, as a column.
    Eigen::VectorXcd row(const Eigen::VectorXcd& c) const
    {
        Eigen::VectorXcd y = c;
        auto memories = y.tail(y.size() - core);
        const Eigen::Vector3cd motion = core_.transpose()
                                        * (c.head<core>() + forth_.transpose() * c.tail(c.size() - core));
        solveOwn(memories, true);
        y.head<core>() = motion;
        memories.noalias() += back_.transpose() * motion;
        return inOrder(y).cwiseQuotient(units_);
    }

private:
    static constexpr Eigen::Index core = 3;
    struct Group {
        Eigen::Index first, size;
    };

    /// The library's division and decomposition take several times as long.
    static std::complex<double> reciprocal(std::complex<double> z) { return std::conj(z) / std::norm(z); }
    static void invert(const Eigen::MatrixXcd& M, Eigen::MatrixXcd& inverse)
    {
        if (M.rows() != 2) {
            inverse = ComplexLu(M).inverse();
            return;
        }
        const auto by = reciprocal(M(0, 0) * M(1, 1) - M(0, 1) * M(1, 0));
        inverse.resize(2, 2);
        inverse << by * M(1, 1), -by * M(0, 1), -by * M(1, 0), by * M(0, 0);
    }

    /// For each state, the first state that it is coupled with, other than through the core. Not for the core's states.
    static std::vector<Eigen::Index> groupsOf(const Eigen::MatrixXd& A)
    {
        std::vector<Eigen::Index> group(static_cast<std::size_t>(A.rows()));
        for (Eigen::Index k = 0; k < A.rows(); ++k)
            group[static_cast<std::size_t>(k)] = k;
        for (Eigen::Index r = core; r < A.rows(); ++r)
            for (Eigen::Index c = core; c < A.cols(); ++c)
                if (r != c && A(r, c) != 0.0) {
                    const auto one = group[static_cast<std::size_t>(r)], other = group[static_cast<std::size_t>(c)];
                    std::replace(group.begin(), group.end(), std::max(one, other), std::min(one, other));
                }
        return group;
    }
    Eigen::Index size(const std::vector<Eigen::Index>& groups, Eigen::Index place) const
    {
        return std::count(groups.begin(), groups.end(),
                          groups[static_cast<std::size_t>(order_[static_cast<std::size_t>(place)])]);
    }
    /// Single states first, then group by group.
    static bool before(const std::vector<Eigen::Index>& groups, Eigen::Index a, Eigen::Index b)
    {
        const auto first = groups[static_cast<std::size_t>(a)], second = groups[static_cast<std::size_t>(b)];
        const bool alone = std::count(groups.begin(), groups.end(), first) == 1,
                   other = std::count(groups.begin(), groups.end(), second) == 1;
        return alone != other ? alone : first < second;
    }

    /// R_g of each group times its part of y, or the transpose of it.
    template <class Vector>
    void solveOwn(Vector& y, bool transposed) const
    {
        y.head(singles_).array() *= own_.array();
        for (std::size_t g = 0; g < groups_.size(); ++g) {
            auto part = y.segment(groups_[g].first - core, groups_[g].size);
            if (transposed)
                part = (solved_[g].transpose() * part).eval();
            else
                part = (solved_[g] * part).eval();
        }
    }

    Eigen::VectorXcd inOrder(const Eigen::VectorXcd& y) const
    {
        Eigen::VectorXcd z(y.size());
        z(order_) = y;
        return z;
    }

    Eigen::VectorXd units_;
    /// places in A of the states in the order used here: the core, single states, groups
    std::vector<Eigen::Index> order_;
    std::vector<Group> groups_;  ///< groups of two states or more
    Eigen::Index singles_ = 0;
    Eigen::MatrixXcd A_, into_, from_;        ///< into the memories from the core, and back
    Eigen::VectorXcd poles_, own_;            ///< of single states, and 1/(s - pole)
    std::vector<Eigen::MatrixXcd> solved_;    ///< R_g
    Eigen::MatrixXcd forth_, back_, system_;  ///< R_g A_gc and A_cg R_g
    Eigen::Matrix3cd core_;                   ///< S^-1
};

}  // namespace excursion
