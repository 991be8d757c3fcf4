// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Narx/NarxRecursion.h"

#include "Engine/Error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace excursion {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

NarxRecursion::NarxRecursion(const Narx& structure)
    : na_(structure.outputLags),
      nb_(structure.inputLags),
      terms_(structure.exponents.rows()),
      products_(structure.exponents, na_ + nb_ + 1, na_)
{
}

void NarxRecursion::place(const VectorXd& input, const VectorXd& output, Index t, VectorXd& nodes) const
{
    for (Index i = 1; i <= na_; ++i)
        nodes[i] = t >= i ? output[t - i] : 0.0;
    for (Index i = 1; i <= nb_; ++i)
        nodes[na_ + i] = t >= i ? input[t - i] : 0.0;
    nodes[na_ + nb_ + 1] = input[t];
    products_.evaluate(nodes.data());
}

VectorXd NarxRecursion::weights(const VectorXd& coefficients) const
{
    VectorXd w = VectorXd::Zero(products_.nodes());
    for (Index k = 0; k < terms_; ++k)
        w[products_.termNode(k)] += coefficients[k];
    return w;
}

Index NarxRecursion::run(const VectorXd& coefficients, const VectorXd& input, double bound, VectorXd& output) const
{
    const VectorXd w = weights(coefficients);
    VectorXd values(products_.nodes());
    output.resize(input.size());
    for (Index t = 0; t < input.size(); ++t) {
        place(input, output, t, values);
        output[t] = w.dot(values);
        if (!(std::abs(output[t]) <= bound))
            return t;
    }
    return input.size();
}

MatrixXd NarxRecursion::regressors(const VectorXd& input, const VectorXd& output, Index first, Index rows) const
{
    MatrixXd r(rows, terms_);
    VectorXd values(products_.nodes());
    for (Index t = 0; t < rows; ++t) {
        place(input, output, first + t, values);
        for (Index k = 0; k < terms_; ++k)
            r(t, k) = values[products_.termNode(k)];
    }
    return r;
}

void NarxRecursion::differentiate(const VectorXd& coefficients, const VectorXd& input, const VectorXd& output,
                                  const Consumer& consume) const
{
    constexpr Index stretch = 256;
    MatrixXd S = MatrixXd::Zero(terms_, na_ + stretch);  // the last na derivatives, then those of the stretch
    VectorXd slopes(na_), values(products_.nodes());
    for (Index first = 0; first < input.size(); first += stretch) {
        const Index T = std::min(stretch, input.size() - first);
        for (Index t = 0; t < T; ++t) {
            place(input, output, first + t, values);
            slopes.setZero();
            for (const auto& slope : products_.slopes())
                slopes[slope.state] += coefficients[slope.term] * slope.factor * values[slope.node];
            auto s = S.col(na_ + t);
            for (Index k = 0; k < terms_; ++k)
                s[k] = values[products_.termNode(k)];
            for (Index i = 1; i <= na_; ++i)
                s += slopes[i - 1] * S.col(na_ + t - i);
        }
        consume(first, S.middleCols(na_, T).transpose());
        S.leftCols(na_) = S.middleCols(T, na_).eval();
    }
}

Eigen::MatrixXd simulate(const Narx& model, const Eigen::MatrixXd& input)
{
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be simulated: " + reason + ".");
    if (input.cols() != 1)
        throw Error(Error::Kind::usage, "A NARX model has one input, but the record has another number.");
    Eigen::VectorXd output;
    const auto lasted = NarxRecursion(model).run(model.coefficients, input.col(0), std::numeric_limits<double>::max(),
                                                 output);
    output.tail(output.size() - lasted).setConstant(std::numeric_limits<double>::quiet_NaN());
    return output;
}

}  // namespace excursion
