// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Block/BlockModel.h"

#include "Engine/Error.h"
#include "Engine/Linear/Simulation.h"
#include "Engine/Validity.h"

#include <cmath>

namespace excursion {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::string_view name(BlockBranch branch)
{
    switch (branch) {
    case BlockBranch::hammerstein: return "hammerstein";
    case BlockBranch::wiener: return "wiener";
    case BlockBranch::feedback: return "feedback";
    }
    return "";
}

std::vector<BlockBranch> blockBranches()
{
    return {BlockBranch::hammerstein, BlockBranch::wiener, BlockBranch::feedback};
}

const VectorXd& BlockModel::of(BlockBranch branch) const
{
    return branch == BlockBranch::hammerstein ? hammerstein : branch == BlockBranch::wiener ? wiener : feedback;
}

VectorXd& BlockModel::of(BlockBranch branch)
{
    return branch == BlockBranch::hammerstein ? hammerstein : branch == BlockBranch::wiener ? wiener : feedback;
}

const VectorXd& BlockOutputs::of(BlockBranch branch) const
{
    return branch == BlockBranch::hammerstein ? hammerstein : branch == BlockBranch::wiener ? wiener : feedback;
}

Index BlockModel::parameters() const
{
    return 2 * linear.order() + 2 + hammerstein.size() + wiener.size() + feedback.size();
}

bool BlockModel::isValid(std::string* reason) const
{
    if (!linear.isValid(reason))
        return false;
    if (linear.continuous() || linear.inputs() != 1 || linear.outputs() != 1)
        return refuse(reason,
                      "the linear part of a block model is one of discrete time, with one input and one output");
    if (!hammerstein.allFinite() || !wiener.allFinite() || !feedback.allFinite() || !std::isfinite(offset))
        return refuse(reason, "a coefficient of a polynomial is not finite");
    if (std::max({hammerstein.size(), wiener.size(), feedback.size()}) > 19)
        return refuse(reason, "the polynomials of a block model go up to degree 20");
    return true;
}

ArrayXd polynomial(const VectorXd& coefficients, const ArrayXd& v)
{
    ArrayXd sum = ArrayXd::Zero(v.size());
    for (Index k = coefficients.size(); k-- > 0;)
        sum = sum * v + coefficients[k];
    return sum * v * v;
}

ArrayXd polynomialSlope(const VectorXd& coefficients, const ArrayXd& v)
{
    ArrayXd sum = ArrayXd::Zero(v.size());
    for (Index k = coefficients.size(); k-- > 0;)
        sum = sum * v + static_cast<double>(k + 2) * coefficients[k];
    return sum * v;
}

BlockOutputs branchOutputs(const BlockModel& model, const MatrixXd& input)
{
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be simulated: " + reason + ".");
    if (input.cols() != 1)
        throw Error(Error::Kind::usage, "A block model has one input, but the record has another number.");
    const auto through = [&](const VectorXd& coefficients, const VectorXd& v) -> VectorXd {
        if (coefficients.size() == 0)
            return VectorXd::Zero(v.size());
        return simulate(model.linear, polynomial(coefficients, v.array()).matrix());
    };
    BlockOutputs outputs;
    outputs.linear = simulate(model.linear, input);
    outputs.hammerstein = through(model.hammerstein, input.col(0));
    outputs.wiener = polynomial(model.wiener, outputs.linear.array());
    outputs.feedback = through(model.feedback, outputs.linear);
    return outputs;
}

MatrixXd simulate(const BlockModel& model, const MatrixXd& input)
{
    const auto outputs = branchOutputs(model, input);
    return (outputs.linear + outputs.hammerstein + outputs.wiener + outputs.feedback).array() + model.offset;
}

namespace {

/// With the polynomials driving the last of one or two copies of G: one closes the loop.
Pnlss written(const BlockModel& model, Index copies)
{
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be written as PNLSS: " + reason + ".");
    const auto& G = model.linear;
    const auto n = G.order(), states = copies * n;
    const auto highest = static_cast<int>(
                             std::max({model.hammerstein.size(), model.wiener.size(), model.feedback.size()}))
                         + 1;
    // of (x, u)
    const Exponents powers = highest > 1 ? monomials(static_cast<int>(n) + 1, 2, highest) : Exponents(0, n + 1);
    const auto K = 1 + powers.rows();
    Pnlss result;
    result.linear.sampleRate = G.sampleRate;
    result.linear.A = MatrixXd::Zero(states, states);
    result.linear.A.topLeftCorner(n, n) = result.linear.A.bottomRightCorner(n, n) = G.A;
    result.linear.B = MatrixXd::Zero(states, 1);
    result.linear.B.topRows(n) = G.B;
    result.linear.C = G.C.replicate(1, copies);
    result.linear.D = G.D;
    result.exponents = Exponents::Zero(K, states + 1);
    result.exponents.bottomRows(K - 1).leftCols(n) = powers.leftCols(n);
    result.exponents.bottomRows(K - 1).rightCols(1) = powers.rightCols(1);
    result.E = MatrixXd::Zero(states, K);
    result.F = MatrixXd::Zero(1, K);
    result.F(0, 0) = model.offset;
    const auto coefficient = [](const VectorXd& c, int degree) { return degree - 2 < c.size() ? c[degree - 2] : 0.0; };
    for (Index k = 1; k < K; ++k) {
        const auto row = powers.row(k - 1);
        const int degree = row.sum();
        // Of w^degree, w = C x + D u: the multinomial theorem
        double share = std::tgamma(degree + 1.0);
        for (Index v = 0; v <= n; ++v)
            share *= std::pow(v < n ? G.C(0, v) : G.D(0, 0), row[v]) / std::tgamma(row[v] + 1.0);
        const double driving = coefficient(model.feedback, degree) * share
                               + (row[n] == degree ? coefficient(model.hammerstein, degree) : 0.0);
        result.E.col(k).tail(n) = G.B * driving;
        result.F(0, k) = G.D(0, 0) * driving + coefficient(model.wiener, degree) * share;
    }
    result.free = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>::Constant(states + 1, K, false);
    result.free.bottomRows(n + 1).setConstant(true);
    return result;
}

}  // namespace

Pnlss pnlssOf(const BlockModel& model) { return written(model, 2); }

Pnlss closedLoop(const BlockModel& model) { return written(model, 1); }

}  // namespace excursion
