// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Pnlss/Pnlss.h"

#include "Engine/Error.h"
#include "Engine/Numerics/LuFactors.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A polynomial in the new states and the inputs: coefficient by exponents.
using Polynomial = std::map<std::vector<int>, double>;

Polynomial product(const Polynomial& a, const Polynomial& b)
{
    Polynomial result;
    for (const auto& [ea, ca] : a)
        for (const auto& [eb, cb] : b) {
            auto e = ea;
            for (std::size_t k = 0; k < e.size(); ++k)
                e[k] += eb[k];
            result[e] += ca * cb;
        }
    return result;
}

void requireDiscrete(const StateSpace& linear)
{
    if (linear.continuous())
        throw Error(Error::Kind::usage,
                    "A polynomial state-space model is built on a linear model of discrete time; transform it first.");
}

}  // namespace

bool Pnlss::isValid(std::string* reason) const
{
    if (!fits(reason))
        return false;
    return !linear.continuous() || refuse(reason, "a PNLSS model is one of discrete time, but its sample rate is 0");
}

bool Pnlss::fits(std::string* reason) const
{
    if (!linear.isValid(reason))
        return false;
    const auto n = linear.order(), m = linear.inputs(), p = linear.outputs(), K = terms();
    if (K > 0 && exponents.cols() != n + m)
        return refuse(reason, "the exponents of a monomial must be as many as states and inputs");
    if (K > 0 && (exponents.minCoeff() < 0 || (exponents.rowwise().sum().array() == 1).any()))
        return refuse(
            reason,
            "a monomial needs exponents of at least 0 and a degree that is not 1, as A, B, C and D are of degree 1");
    if (E.rows() != n || E.cols() != K || F.rows() != p || F.cols() != K || free.rows() != n + p || free.cols() != K)
        return refuse(reason, "E, F and what is free must have one column a monomial, and rows as A and C");
    if (!E.allFinite() || !F.allFinite())
        return refuse(reason, "a coefficient of E or F is not finite");
    return true;
}

Pnlss withTerms(const StateSpace& linear, const Exponents& chosen)
{
    requireDiscrete(linear);
    Pnlss model;
    model.linear = linear;
    model.exponents = chosen;
    model.E = MatrixXd::Zero(linear.order(), chosen.rows());
    model.F = MatrixXd::Zero(linear.outputs(), chosen.rows());
    model.free.setConstant(linear.order() + linear.outputs(), chosen.rows(), true);
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, "These monomials make no model: " + reason + ".");
    std::set<std::vector<int>> seen;
    for (Index k = 0; k < chosen.rows(); ++k)
        if (const Eigen::RowVectorXi row = chosen.row(k); !seen.emplace(row.begin(), row.end()).second)
            throw Error(Error::Kind::usage, "These monomials make no model: number " + std::to_string(k + 1)
                                                + " of the list occurs twice.");
    return model;
}

Pnlss withTerms(const StateSpace& linear, int degree, TermMask mask, bool offset)
{
    requireDiscrete(linear);
    if (degree < 2)
        throw Error(Error::Kind::usage, "The degree of a polynomial state-space model must be at least 2.");
    const auto n = static_cast<int>(linear.order()), p = static_cast<int>(linear.outputs());
    const auto all = monomials(n + static_cast<int>(linear.inputs()), 2, degree);
    const auto use = allowed(mask, all, n, p);
    std::vector<Index> kept;
    for (Index k = 0; k < all.rows(); ++k)
        if (use.col(k).any())
            kept.push_back(k);
    const Index constant = offset ? 1 : 0, count = static_cast<Index>(kept.size());
    Exponents chosen = Exponents::Zero(constant + count, all.cols());
    chosen.bottomRows(count) = all(kept, Eigen::all);
    auto model = withTerms(linear, chosen);
    for (Index k = 0; k < count; ++k)
        model.free.col(constant + k) = use.col(kept[static_cast<std::size_t>(k)]);
    return model;
}

void keepOutputLinear(Pnlss& model)
{
    for (Index k = 0; k < model.terms(); ++k)
        if (model.exponents.row(k).sum() > 0)
            model.free.bottomRows(model.linear.outputs()).col(k).setConstant(false);
}

MatrixXd simulate(const Pnlss& model, const MatrixXd& input, const VectorXd& initial)
{
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be simulated: " + reason + ".");
    const auto n = model.linear.order(), m = model.linear.inputs();
    if (input.cols() != m || (initial.size() != 0 && initial.size() != n))
        throw Error(Error::Kind::usage, "The input or the initial state does not fit the model.");
    VectorXd z(n + m), monomial(model.terms());
    z.head(n) = initial.size() != 0 ? initial : VectorXd::Zero(n);
    MatrixXd output(input.rows(), model.linear.outputs());
    for (Index t = 0; t < input.rows(); ++t) {
        z.tail(m) = input.row(t).transpose();
        for (Index k = 0; k < model.terms(); ++k) {
            double value = 1.0;
            for (Index v = 0; v < n + m; ++v)
                for (int power = model.exponents(k, v); power > 0; --power)
                    value *= z[v];
            monomial[k] = value;
        }
        output.row(t) = model.linear.C * z.head(n) + model.linear.D * z.tail(m) + model.F * monomial;
        const VectorXd next = model.linear.A * z.head(n) + model.linear.B * z.tail(m) + model.E * monomial;
        z.head(n) = next;
    }
    return output;
}

Pnlss transformed(const Pnlss& model, const MatrixXd& T)
{
    const auto n = model.linear.order(), m = model.linear.inputs();
    if (T.rows() != n || T.cols() != n)
        throw Error(Error::Kind::usage, "A change of the states needs a square matrix of their number.");
    // Old variable v as a polynomial in the new ones
    std::vector<Polynomial> variable(static_cast<std::size_t>(n + m));
    for (Index v = 0; v < n + m; ++v)
        for (Index w = 0; w < n + m; ++w) {
            const double c = v < n && w < n ? T(v, w) : v == w ? 1.0 : 0.0;
            std::vector<int> e(static_cast<std::size_t>(n + m), 0);
            e[static_cast<std::size_t>(w)] = 1;
            if (c != 0.0)
                variable[static_cast<std::size_t>(v)][e] = c;
        }
    const Eigen::VectorXi degrees = model.exponents.rowwise().sum();
    const auto powers = monomials(static_cast<int>(n + m), 2, std::max(2, model.terms() > 0 ? degrees.maxCoeff() : 2));
    const Index constant = (degrees.array() == 0).any() ? 1 : 0;
    Exponents all = Exponents::Zero(constant + powers.rows(), n + m);
    all.bottomRows(powers.rows()) = powers;
    std::map<std::vector<int>, Index> place;
    for (Index k = 0; k < all.rows(); ++k) {
        std::vector<int> e(static_cast<std::size_t>(n + m));
        for (Index v = 0; v < n + m; ++v)
            e[static_cast<std::size_t>(v)] = all(k, v);
        place[e] = k;
    }
    MatrixXd E = MatrixXd::Zero(n, all.rows()), F = MatrixXd::Zero(model.linear.outputs(), all.rows());
    for (Index k = 0; k < model.terms(); ++k) {
        Polynomial expanded {{std::vector<int>(static_cast<std::size_t>(n + m), 0), 1.0}};
        for (Index v = 0; v < n + m; ++v)
            for (int power = model.exponents(k, v); power > 0; --power)
                expanded = product(expanded, variable[static_cast<std::size_t>(v)]);
        for (const auto& [e, c] : expanded) {
            E.col(place.at(e)) += c * model.E.col(k);
            F.col(place.at(e)) += c * model.F.col(k);
        }
    }
    Pnlss result;
    result.linear = transformed(model.linear, T);
    result.exponents = all;
    result.E = RealLu(T).solve(E);
    result.F = F;
    result.free.setConstant(n + model.linear.outputs(), all.rows(), true);
    return result;
}

}  // namespace excursion
