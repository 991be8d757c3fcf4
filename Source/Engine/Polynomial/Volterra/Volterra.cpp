// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Volterra/Volterra.h"

#include "Engine/Error.h"
#include "Engine/Linear/Response.h"
#include "Engine/Numerics/LuFactors.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr int highestOrder = 6;

/// Numbers with one component a subset of n symbols whose squares are 0: (a b)_S = sum_{T in S} a_T b_{S-T}.
struct Subsets {
    Index symbols;
    Index size() const { return Index {1} << symbols; }

    template <class Row>
    auto product(const Row& a, const Row& b, Index S) const
    {
        auto sum = a(0) * b(S);
        for (Index T = S; T > 0; T = (T - 1) & S)
            sum += a(T) * b(S ^ T);
        return sum;
    }
};

/// Truncated power series: (a b)_k = sum_l a_l b_{k-l}.
struct Powers {
    Index highest;
    Index size() const { return highest + 1; }

    template <class Row>
    auto product(const Row& a, const Row& b, Index k) const
    {
        auto sum = a(0) * b(k);
        for (Index l = 1; l <= k; ++l)
            sum += a(l) * b(k - l);
        return sum;
    }
};

double factorial(std::size_t n) { return std::tgamma(static_cast<double>(n) + 1.0); }

void requireOrder(std::size_t order)
{
    if (order < 1 || order > highestOrder)
        throw Error(Error::Kind::usage,
                    "Volterra kernels are computed of orders 1 to " + std::to_string(highestOrder) + ".");
}

}  // namespace

template <class Algebra, class Number>
void Volterra::multiply(const Algebra& algebra, Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic>& nodes,
                        Index component) const
{
    // Column after column a node, as nodes are made of earlier ones
    Index node = 1 + model_.linear.order() + model_.linear.inputs();
    for (const auto& product : products_.products())
        nodes(component, node++) = algebra.product(nodes.col(product.left), nodes.col(product.right), component);
}

Volterra::Volterra(const Pnlss& model)
    : model_(model), products_(model.exponents, model.linear.order() + model.linear.inputs(), model.linear.order())
{
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, "The model has no Volterra kernels: " + reason + ".");
    const auto n = model.linear.order(), m = model.linear.inputs(), p = model.linear.outputs();
    toState_ = MatrixXd::Zero(n, products_.nodes());
    toOutput_ = MatrixXd::Zero(p, products_.nodes());
    toState_.middleCols(1, n) = model.linear.A;
    toState_.middleCols(1 + n, m) = model.linear.B;
    toOutput_.middleCols(1, n) = model.linear.C;
    toOutput_.middleCols(1 + n, m) = model.linear.D;
    for (Index k = 0; k < model.terms(); ++k) {
        toState_.col(products_.termNode(k)) += model.E.col(k);
        toOutput_.col(products_.termNode(k)) += model.F.col(k);
    }
    // Newton's steps to x0 = A x0 + E p(x0, 0)
    rest_ = VectorXd::Zero(n);
    VectorXd nodes = VectorXd::Zero(products_.nodes());
    double missing = 0.0;
    for (int step = 0; step < 50; ++step) {
        nodes.segment(1, n) = rest_;
        products_.evaluate(nodes.data());
        slope_ = model.linear.A;
        for (const auto& slope : products_.slopes())
            slope_.col(slope.state) += slope.factor * nodes[slope.node] * model.E.col(slope.term);
        const VectorXd error = rest_ - toState_ * nodes;
        missing = n > 0 ? error.cwiseAbs().maxCoeff() : 0.0;
        if (!(missing > 1e-14 * std::max(rest_.cwiseAbs().maxCoeff(), 1e-300)))
            break;
        rest_ -= RealLu(MatrixXd::Identity(n, n) - slope_).solve(error);
    }
    if (!rest_.allFinite() || !(missing <= 1e-9 * std::max(1e-300, n > 0 ? rest_.cwiseAbs().maxCoeff() : 0.0)))
        throw Error(Error::Kind::numerical, "The model has no Volterra kernels: no state was found in which it rests.");
    offset_ = toOutput_ * nodes;
    auto around = model.linear;
    around.A = slope_;
    if (!isStable(around))
        throw Error(Error::Kind::data, "The model has no Volterra kernels: it is not stable around its rest.");
}

std::vector<Index> Volterra::inputsOf(std::size_t order, const std::vector<Index>& given) const
{
    auto inputs = given.empty() ? std::vector<Index>(order, 0) : given;
    for (const auto input : inputs)
        if (inputs.size() != order || input < 0 || input >= model_.linear.inputs())
            throw Error(Error::Kind::usage,
                        "A Volterra kernel needs as many inputs as its order, each of them one of the model's.");
    return inputs;
}

VectorXcd Volterra::response(const std::vector<double>& frequency, const std::vector<Index>& given) const
{
    requireOrder(frequency.size());
    const auto inputs = inputsOf(frequency.size(), given);
    const auto n = model_.linear.order();
    const Subsets algebra {static_cast<Index>(frequency.size())};
    MatrixXcd nodes = MatrixXcd::Zero(algebra.size(), products_.nodes());
    nodes(0, 0) = 1.0;
    nodes.row(0).segment(1, n) = rest_.transpose().cast<std::complex<double>>();
    multiply(algebra, nodes, 0);
    for (Index S = 1; S < algebra.size(); ++S) {
        double sum = 0.0;
        for (std::size_t i = 0; i < frequency.size(); ++i)
            if (S >> i & 1)
                sum += frequency[i];
        if (std::has_single_bit(static_cast<unsigned>(S)))
            nodes(S, 1 + n + inputs[static_cast<std::size_t>(std::countr_zero(static_cast<unsigned>(S)))]) = 1.0;
        // Once without x_S: what drives it; its own part of p(x) is in the slope. Then with it.
        multiply(algebra, nodes, S);
        const auto lambda = evaluationPoint(sum, model_.linear.sampleRate);
        MatrixXcd system = (MatrixXd::Identity(n, n) - slope_).cast<std::complex<double>>();
        system.diagonal().array() += lambda;
        const VectorXcd drive = toState_ * nodes.row(S).transpose();
        nodes.row(S).segment(1, n) = ComplexLu(system).solve(drive).transpose();
        multiply(algebra, nodes, S);
    }
    return toOutput_ * nodes.row(algebra.size() - 1).transpose() / factorial(frequency.size());
}

MatrixXd Volterra::kernel(const std::vector<Index>& impulses, Index length, const std::vector<Index>& given) const
{
    requireOrder(impulses.size());
    const auto inputs = inputsOf(impulses.size(), given);
    if (length < 0 || std::any_of(impulses.begin(), impulses.end(), [](Index s) { return s < 0; }))
        throw Error(Error::Kind::usage,
                    "A Volterra kernel needs impulses at time 0 or later, and a length of at least 0.");
    const auto n = model_.linear.order();
    const Subsets algebra {static_cast<Index>(impulses.size())};
    MatrixXd nodes = MatrixXd::Zero(algebra.size(), products_.nodes()), result(length, model_.linear.outputs());
    nodes(0, 0) = 1.0;
    nodes.row(0).segment(1, n) = rest_.transpose();
    for (Index t = 0; t < length; ++t) {
        for (std::size_t i = 0; i < impulses.size(); ++i)
            nodes(Index {1} << i, 1 + n + inputs[i]) = impulses[i] == t ? 1.0 : 0.0;
        for (Index S = 0; S < algebra.size(); ++S)
            multiply(algebra, nodes, S);
        result.row(t) = toOutput_ * nodes.row(algebra.size() - 1).transpose() / factorial(impulses.size());
        const MatrixXd next = nodes.bottomRows(algebra.size() - 1) * toState_.transpose();
        nodes.block(1, 1, algebra.size() - 1, n) = next;
    }
    return result;
}

std::vector<MatrixXd> Volterra::parts(const MatrixXd& input, int highest) const
{
    requireOrder(static_cast<std::size_t>(std::max(highest, 0)));
    const auto n = model_.linear.order(), m = model_.linear.inputs();
    if (input.cols() != m)
        throw Error(Error::Kind::usage, "The input does not fit the model.");
    const Powers algebra {highest};
    std::vector<MatrixXd> result(static_cast<std::size_t>(highest), MatrixXd(input.rows(), model_.linear.outputs()));
    MatrixXd nodes = MatrixXd::Zero(algebra.size(), products_.nodes());
    nodes(0, 0) = 1.0;
    nodes.row(0).segment(1, n) = rest_.transpose();
    for (Index t = 0; t < input.rows(); ++t) {
        nodes.row(1).segment(1 + n, m) = input.row(t);
        for (Index k = 0; k <= highest; ++k)
            multiply(algebra, nodes, k);
        for (Index k = 1; k <= highest; ++k)
            result[static_cast<std::size_t>(k - 1)].row(t) = toOutput_ * nodes.row(k).transpose();
        const MatrixXd next = nodes.bottomRows(highest) * toState_.transpose();
        nodes.block(1, 1, highest, n) = next;
    }
    return result;
}

}  // namespace excursion
